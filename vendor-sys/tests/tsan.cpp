// Several concurrent callers factor grids with task trees, under ThreadSanitizer (threads.rs compiles and runs this).

#include "SuiteSparseQR_C.h"

#include <cstdio>
#include <thread>
#include <vector>

extern "C" void qless_tree_kernel(SuiteSparse_long task, void *blob);
extern "C" int qless_tree_threads(int threads);
extern "C" unsigned long long qless_tree_count();
extern "C" unsigned long long qless_result_copies();

// The functions that tree.rs exports to the library.
extern "C" void stand_in(SuiteSparse_long task, void *blob) __asm__("_Z11spqr_kernelIdEvlP9spqr_blobIT_E");
extern "C" void stand_in(SuiteSparse_long task, void *blob)
{
    qless_tree_kernel(task, blob);
}

using Index = SuiteSparse_long;
extern "C" void qless_result_count(void *, void *, Index, Index, Index, int, Index *, Index *, Index *, Index *);
extern "C" void qless_result_convert(void *, void *, Index, Index, Index, int, Index *, Index *, double *, Index *, Index *,
                                     double *, Index *, Index *, double *, double *);

extern "C" void count_r(void *, void *, Index, Index, Index, int, Index *, Index *, Index *, Index *)
    __asm__("_Z11spqr_rcountIdEvP13spqr_symbolicP12spqr_numericIT_EllliPlS6_S6_S6_");
extern "C" void count_r(void *symbolic, void *numeric, Index first, Index econ, Index n2, int transpose, Index *a, Index *b,
                        Index *h, Index *vectors)
{
    qless_result_count(symbolic, numeric, first, econ, n2, transpose, a, b, h, vectors);
}

extern "C" void copy_r(void *, void *, Index, Index, Index, int, Index *, Index *, double *, Index *, Index *, double *, Index *,
                       Index *, double *, double *)
    __asm__("_Z13spqr_rconvertIdEvP13spqr_symbolicP12spqr_numericIT_EllliPlS6_PS3_S6_S6_S7_S6_S6_S7_S7_");
extern "C" void copy_r(void *symbolic, void *numeric, Index first, Index econ, Index n2, int transpose, Index *ap, Index *ai,
                       double *ax, Index *bp, Index *bi, double *bx, Index *hp, Index *hi, double *hx, double *tau)
{
    qless_result_convert(symbolic, numeric, first, econ, n2, transpose, ap, ai, ax, bp, bi, bx, hp, hi, hx, tau);
}

// Factors the edges x nodes matrix of a square grid and returns its rank, which is one less than the number of nodes.
static long rank_of_grid(long side)
{
    std::vector<std::vector<std::pair<long, double>>> columns(side * side);
    long rows = 0;
    for (long node = 0; node < side * side; node++)
        for (long other : {node % side + 1 < side ? node + 1 : -1, node + side < side * side ? node + side : -1})
            if (other >= 0)
            {
                columns[node].push_back({rows, 1.0});
                columns[other].push_back({rows++, -1.5});
            }
    cholmod_common common;
    cholmod_l_start(&common);
    common.SPQR_grain = 16;
    common.SPQR_small = 1;
    cholmod_sparse *a = cholmod_l_allocate_sparse(rows, side * side, 2 * rows, 1, 1, 0, CHOLMOD_REAL, &common);
    long at = 0;
    for (long j = 0; j <= side * side; j++)
    {
        static_cast<SuiteSparse_long *>(a->p)[j] = at;
        if (j < side * side)
            for (auto [row, value] : columns[j])
            {
                static_cast<SuiteSparse_long *>(a->i)[at] = row;
                static_cast<double *>(a->x)[at++] = value;
            }
    }
    cholmod_sparse *r = nullptr;
    SuiteSparse_long *order = nullptr;
    const long rank = SuiteSparseQR_C(SPQR_ORDERING_DEFAULT, 1e-10, rows, 0, a, nullptr, nullptr, nullptr, nullptr, &r, &order,
                                      nullptr, nullptr, nullptr, &common);
    cholmod_l_free(side * side, sizeof(SuiteSparse_long), order, &common);
    cholmod_l_free_sparse(&r, &common);
    cholmod_l_free_sparse(&a, &common);
    cholmod_l_finish(&common);
    return rank;
}

int main()
{
    std::vector<std::thread> callers;
    std::vector<long> ranks(4);
    for (int k = 0; k < 4; k++)
        callers.emplace_back([k, &ranks] {
            qless_tree_threads(2);
            for (int round = 0; round < 5; round++)
                ranks[k] = rank_of_grid(20 + k) - (20 + k) * (20 + k) + 1;
        });
    for (std::thread &caller : callers)
        caller.join();
    std::printf("%llu trees, %llu copies of R, ranks %s\n", qless_tree_count(), qless_result_copies(), ranks == std::vector<long>(4) ? "as expected" : "wrong");
}
