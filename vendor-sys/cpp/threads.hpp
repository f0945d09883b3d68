// What the task tree and the copy of R share: how many threads the caller wants, and how work is given to them.

#pragma once

#include <cstddef>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace qless
{

// What the caller on this thread asked for: 0 or 1 leaves the library alone.
extern thread_local int wanted_threads;

// The same, but no more than there are cores, which would only take turns.
int threads();

// Whether the factorization just made on this thread, of which this is the numeric object, ran its tasks in a tree.
bool has_tree(const void *numeric);

// oneTBB orders the start of its tasks after what came before and their end before what comes then, by means that ThreadSanitizer
// cannot see. So it is said again: whoever looks comes after all who marked before.
void mark();
void look();

// Does work(0), ..., work(count - 1), which throw nothing, in oneTBB. Without memory or threads for all some may not be done.
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
        // oneTBB found no memory or no thread: what was done is done, the rest is the caller's.
    }
    look();
}

} // namespace qless
