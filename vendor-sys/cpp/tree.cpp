// SuiteSparseQR's task tree on oneTBB.
//
// The library splits the frontal tree into tasks when cc->SPQR_grain > 1 and then calls spqr_kernel for one task after the
// other, children first. It makes these calls through the dynamic linker, so a definition in the program takes their place:
// the one exported by tree.rs, which comes here. On the first task of a factorization whose caller asked for threads, all
// tasks are run in oneTBB, each as soon as its children are done; the calls for the others then find their work done.
// Every task does what it does in sequence, on its own memory, so results are the same to the last bit.

#include "SuiteSparseQR.hpp"
#include "spqr.hpp"

#include <algorithm>
#include <atomic>
#include <memory>
#include <vector>

#include <dlfcn.h>
#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/version.h>

#if SPQR_MAIN_VERSION != 2 || SPQR_SUB_VERSION != 1
#error "the task tree is written for SuiteSparseQR 2.1"
#endif

namespace
{

using Blob = spqr_blob<double>;
using Kernel = void (*)(Long, Blob *);

// What the caller on this thread asked for: 0 or 1 leaves the library alone.
thread_local int wanted_threads = 0;
// The factorization whose tasks have all been run.
thread_local const Blob *finished = nullptr;

std::atomic<unsigned long long> trees{0};

// The library's own kernel, the next definition after the program's.
Kernel own_kernel()
{
    static const Kernel kernel =
        reinterpret_cast<Kernel>(dlsym(RTLD_NEXT, "_Z11spqr_kernelIdEvlP9spqr_blobIT_E"));
    return kernel;
}

class Tree
{
public:
    explicit Tree(Blob *blob)
        : blob(blob), root(blob->QRnum->ntasks - 1), parent(root), pending(new std::atomic<Long>[root + 1]),
          done(new std::atomic<bool>[root + 1])
    {
        const spqr_symbolic *symbolic = blob->QRsym;
        for (Long task = 0; task <= root; task++)
        {
            const Long begin = symbolic->TaskChildp[task], end = symbolic->TaskChildp[task + 1];
            pending[task] = end - begin;
            done[task] = false;
            for (Long k = begin; k < end; k++)
                parent[symbolic->TaskChild[k]] = task;
            if (begin == end && task < root)
                leaves.push_back(task);
        }
        ready.store(true, std::memory_order_release);
    }

    void run(int threads)
    {
        try
        {
            tbb::task_arena arena(threads);
            arena.execute([this] {
                tbb::parallel_for(
                    tbb::blocked_range<size_t>(0, leaves.size(), 1),
                    [this](const tbb::blocked_range<size_t> &range) {
                        // oneTBB orders this after the constructor, by means that ThreadSanitizer cannot see; so it is said again.
                        if (ready.load(std::memory_order_acquire))
                            for (size_t k = range.begin(); k != range.end(); k++)
                                upwards(leaves[k]);
                        ended.fetch_add(1, std::memory_order_release);
                    },
                    tbb::simple_partitioner());
            });
        }
        catch (...)
        {
            // oneTBB found no memory or no thread: tasks that ran have run, the rest follows in sequence.
        }
        // As above, for what threads did last.
        ended.load(std::memory_order_acquire);
        for (Long task = 0; task < root; task++)
            if (!done[task])
                own_kernel()(task, blob);
    }

private:
    // Runs a task, and its parent if no other child of it is still to come.
    void upwards(Long task)
    {
        while (task < root)
        {
            own_kernel()(task, blob);
            done[task] = true;
            task = parent[task];
            if (pending[task].fetch_sub(1) != 1)
                return;
        }
    }

    Blob *const blob;
    const Long root;
    std::vector<Long> parent;
    std::vector<Long> leaves;
    std::unique_ptr<std::atomic<Long>[]> pending;
    std::unique_ptr<std::atomic<bool>[]> done;
    std::atomic<bool> ready{false};
    std::atomic<Long> ended{0};
};

bool run_tree(Blob *blob)
{
    try
    {
        // More threads than cores would only take turns.
        Tree(blob).run(std::min(wanted_threads, tbb::info::default_concurrency()));
    }
    catch (...)
    {
        // No memory for the tree itself, and nothing has been run.
        return false;
    }
    return true;
}

} // namespace

extern "C" void qless_tree_kernel(Long task, void *data)
{
    Blob *blob = static_cast<Blob *>(data);
    if (!own_kernel())
    {
        blob->cc->status = CHOLMOD_NOT_INSTALLED;
        return;
    }
    if (task == 0)
    {
        finished = nullptr;
        if (wanted_threads > 1 && blob->QRnum->ntasks > 2 && run_tree(blob))
        {
            finished = blob;
            trees++;
        }
    }
    if (finished != blob)
        own_kernel()(task, blob);
}

extern "C" int qless_tree_threads(int threads)
{
    const int before = wanted_threads;
    wanted_threads = threads;
    finished = nullptr;
    return before;
}

extern "C" unsigned long long qless_tree_count()
{
    return trees;
}

extern "C" const char *qless_tree_runtime()
{
    return TBB_runtime_version();
}
