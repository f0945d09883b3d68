// Shared by the task tree and the copy of R: the requested number of threads, and the distribution of work to them.

#pragma once

#include <cstddef>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace qless
{

// Threads that the caller on this thread requested; 0 or 1 leaves the work to the library.
extern thread_local int wanted_threads;

// The same, but at most one per core.
int threads();

// Whether the last factorization on this thread ran its tasks in a tree; `numeric` is its numeric object.
bool has_tree(const void *numeric);

// oneTBB synchronizes the start and the end of its tasks with the caller, but ThreadSanitizer cannot see that. These functions repeat
// it: look() synchronizes with all earlier calls of mark().
void mark();
void look();

// Runs work(0), ..., work(count - 1) in oneTBB; work must not throw. Some calls may be missing if memory or threads run out.
template <class Work> void share(std::size_t count, const Work &work)
{
    mark();
    try
    {
        tbb::task_arena arena(threads());
        arena.execute([&work, count] {
            tbb::parallel_for(
                tbb::blocked_range<std::size_t>(0, count, 1),
                [&work](const tbb::blocked_range<std::size_t> &range) {
                    look();
                    for (std::size_t k = range.begin(); k != range.end(); k++)
                        work(k);
                    mark();
                },
                tbb::simple_partitioner());
        });
    }
    catch (...)
    {
        // oneTBB ran out of memory or threads: the caller does the remaining work.
    }
    look();
}

} // namespace qless
