// SuiteSparseQR's task tree on oneTBB.
//
// If cc->SPQR_grain > 1 the library splits the frontal tree into tasks and calls spqr_kernel for each, children first. It calls it
// through the dynamic linker, so the function that tree.rs exports replaces it and calls this file. At the first task of a
// factorization whose caller requested threads, all tasks run in oneTBB, each as soon as its children are done. The calls for the
// other tasks then return at once. Every task does the same work on the same memory as in sequence, so results are the same to the
// last bit.

#include "SuiteSparseQR.hpp"
#include "spqr.hpp"

#include "threads.hpp"

#include <algorithm>
#include <atomic>
#include <memory>
#include <mutex>
#include <vector>

#include <dlfcn.h>
#include <tbb/info.h>
#include <tbb/version.h>

#if SPQR_MAIN_VERSION != 2 || SPQR_SUB_VERSION != 1
#error "the task tree is written for SuiteSparseQR 2.1"
#endif

namespace
{

using Blob = spqr_blob<double>;
using Kernel = void (*)(Long, Blob *);

using qless::wanted_threads;

// The factorization whose tasks have all run, and its numeric object.
thread_local const Blob *finished = nullptr;
thread_local const void *made = nullptr;

std::atomic<unsigned long long> trees{0};
std::atomic<unsigned long long> marks{0};

// The library's own kernel: the next definition after ours in the order of the dynamic linker.
Kernel own_kernel()
{
    static const Kernel kernel =
        reinterpret_cast<Kernel>(dlsym(RTLD_NEXT, "_Z11spqr_kernelIdEvlP9spqr_blobIT_E"));
    return kernel;
}

// Upper bound of the operations of a front: a Householder vector for each row or column, applied to the columns to its right.
double operations(const spqr_symbolic &symbolic, Long front)
{
    const double rows = double(symbolic.Fm[front]), columns = double(symbolic.Rp[front + 1] - symbolic.Rp[front]);
    const double vectors = std::min(rows, columns);
    return 4 * vectors * (rows * columns - (rows + columns) * vectors / 2 + vectors * vectors / 3);
}

// Tasks 0 to root - 1, children before parents; the root is a placeholder.
class Tree
{
public:
    explicit Tree(Blob *blob)
        : blob(blob), root(blob->QRnum->ntasks - 1), parent(root, root), path(root + 1),
          pending(new std::atomic<Long>[root + 1]), done(new std::atomic<bool>[root + 1])
    {
        const spqr_symbolic &symbolic = *blob->QRsym;
        for (Long task = 0; task <= root; task++)
        {
            const Long begin = symbolic.TaskChildp[task], end = symbolic.TaskChildp[task + 1];
            pending[task] = end - begin;
            done[task] = false;
            for (Long k = begin; k < end; k++)
                parent[symbolic.TaskChild[k]] = task;
        }
        for (Long task = root - 1; task >= 0; task--)
        {
            path[task] = path[parent[task]];
            for (Long k = symbolic.TaskFrontp[task]; k < symbolic.TaskFrontp[task + 1]; k++)
                path[task] += operations(symbolic, symbolic.TaskFront[k]);
        }
        ready.reserve(root);
        for (Long task = 0; task < root; task++)
            if (pending[task] == 0)
                push(task);
    }

    void run()
    {
        qless::share(ready.size(), [this](std::size_t) { take(); });
        // Zero if all tasks have run.
        if (pending[root] != 0)
            for (Long task = 0; task < root; task++)
                if (!done[task])
                    own_kernel()(task, blob);
    }

private:
    // One runner for each task that is ready at the start. A runner takes the ready task with the longest path to the root. If it
    // completes the last child of another task, it continues with a ready task. So there is a task for every runner, and none waits.
    void take()
    {
        for (Long task = pop(); task != root; task = pop())
        {
            own_kernel()(task, blob);
            done[task] = true;
            const Long next = parent[task];
            if (pending[next].fetch_sub(1) != 1 || next == root)
                return;
            const std::lock_guard<std::mutex> lock(guard);
            push(next);
        }
    }

    void push(Long task)
    {
        ready.push_back(task);
        std::push_heap(ready.begin(), ready.end(), [this](Long a, Long b) { return path[a] < path[b]; });
    }

    Long pop()
    {
        const std::lock_guard<std::mutex> lock(guard);
        if (ready.empty())
            return root; // an exception in another runner has lost a task and ends the run
        std::pop_heap(ready.begin(), ready.end(), [this](Long a, Long b) { return path[a] < path[b]; });
        const Long task = ready.back();
        ready.pop_back();
        return task;
    }

    Blob *const blob;
    const Long root;
    std::vector<Long> parent;
    std::vector<double> path; // operations from a task up to the root
    std::vector<Long> ready;  // a heap, the longest path on top
    std::mutex guard;         // of the heap
    std::unique_ptr<std::atomic<Long>[]> pending;
    std::unique_ptr<std::atomic<bool>[]> done;
};

bool run_tree(Blob *blob)
{
    try
    {
        Tree(blob).run();
    }
    catch (...)
    {
        // Out of memory for the tree itself; no task has run.
        return false;
    }
    return true;
}

} // namespace

extern "C" int qless_tree_runners(int threads)
{
    return std::min(threads, tbb::info::default_concurrency());
}

namespace qless
{

thread_local int wanted_threads = 0;

int threads()
{
    return qless_tree_runners(wanted_threads);
}

bool has_tree(const void *numeric)
{
    return wanted_threads > 1 && made == numeric;
}

void mark()
{
    marks.fetch_add(1, std::memory_order_release);
}

void look()
{
    marks.load(std::memory_order_acquire);
}

} // namespace qless

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
        made = nullptr;
        if (wanted_threads > 1 && blob->QRnum->ntasks > 2 && run_tree(blob))
        {
            finished = blob;
            made = blob->QRnum;
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
    made = nullptr;
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
