// Extracts R by columns from the fronts of a factorization whose tasks ran in a tree.
//
// The library counts the entries of each column (spqr_rcount) and copies them (spqr_rconvert) front by front, on one thread. It
// calls both through the dynamic linker, so the functions that tree.rs exports replace them. Each thread counts some fronts and
// copies some columns, in the library's order, so R is the same to the last bit.
//
// The R block of a front is stored by columns. A column holds the rows found so far: each live pivot column adds one row, and
// the columns after the pivots hold all rows.

#include "SuiteSparseQR.hpp"
#include "spqr.hpp"

#include "threads.hpp"

#include <algorithm>
#include <atomic>
#include <memory>
#include <vector>

#include <dlfcn.h>

namespace
{

using Numeric = spqr_numeric<double>;
using Count = void (*)(spqr_symbolic *, Numeric *, Long, Long, Long, int, Long *, Long *, Long *, Long *);
using Convert = void (*)(spqr_symbolic *, Numeric *, Long, Long, Long, int, Long *, Long *, double *, Long *, Long *, double *,
                         Long *, Long *, double *, double *);

// Number of copies of R that were made here.
std::atomic<unsigned long long> copies{0};

// The library's own function of this name: the next definition after ours in the order of the dynamic linker.
template <class Function> Function own(const char *name)
{
    return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

// The R blocks of all fronts.
struct Fronts
{
    const spqr_symbolic &symbolic;
    const Numeric &numeric;

    // Whether pivot column j was found independent.
    bool is_live(Long j) const
    {
        return !numeric.Rdead || !numeric.Rdead[j];
    }

    // Calls visit(column, entries, count) for each column of a front.
    template <class Visit> void each_column(Long front, const Visit &visit) const
    {
        const Long first = symbolic.Super[front], pivots = symbolic.Super[front + 1] - first;
        const Long begin = symbolic.Rp[front], columns = symbolic.Rp[front + 1] - begin;
        const double *entries = numeric.Rblock[front];
        Long found = 0;
        for (Long k = 0; k < columns; k++)
        {
            found += k < pivots && is_live(first + k);
            visit(symbolic.Rj[begin + k], entries, found);
            entries += found;
        }
    }

    // The first row of R of each front, and the total number of rows.
    std::vector<Long> first_rows() const
    {
        std::vector<Long> rows(symbolic.nf + 1);
        for (Long front = 0; front < symbolic.nf; front++)
        {
            Long found = 0;
            for (Long j = symbolic.Super[front]; j < symbolic.Super[front + 1]; j++)
                found += is_live(j);
            rows[front + 1] = rows[front] + found;
        }
        return rows;
    }
};

// Largest number of shares of the work: each counts in an array over all columns.
std::size_t parts_of_all()
{
    return std::size_t(std::min(qless::threads(), 8));
}

// Like qless::share, but completes all work.
template <class Work> void share_all(std::size_t count, const Work &work)
{
    const std::unique_ptr<std::atomic<bool>[]> done(new std::atomic<bool>[count]);
    for (std::size_t k = 0; k < count; k++)
        done[k] = false;
    qless::share(count, [&](std::size_t k) {
        work(k);
        done[k] = true;
    });
    for (std::size_t k = 0; k < count; k++)
        if (!done[k])
            work(k);
}

// Cuts `total` (ascending sums) into shares of about the same size.
std::vector<Long> cuts(const std::vector<Long> &total, std::size_t parts)
{
    std::vector<Long> cut(parts + 1);
    for (std::size_t k = 1; k < parts; k++)
    {
        const Long goal = Long(double(total.back()) * double(k) / double(parts));
        cut[k] = std::max(cut[k - 1], Long(std::lower_bound(total.begin(), total.end(), goal) - total.begin()));
    }
    cut[parts] = Long(total.size()) - 1;
    return cut;
}

// Adds the number of nonzero entries of each column in rows before `end`.
void count(const Fronts &fronts, Long n1rows, Long end, std::vector<Long> &counts_of_all)
{
    const std::size_t parts = parts_of_all(), n = counts_of_all.size();
    const std::vector<Long> rows = fronts.first_rows();
    std::vector<Long> sizes(rows.size());
    for (std::size_t f = 0; f + 1 < sizes.size(); f++)
        sizes[f + 1] = sizes[f] + (rows[f + 1] - rows[f]) * (fronts.symbolic.Rp[f + 1] - fronts.symbolic.Rp[f]);
    const std::vector<Long> cut = cuts(sizes, parts);
    std::vector<std::vector<Long>> counts(parts, std::vector<Long>(n));
    share_all(parts, [&](std::size_t part) {
        Long *const own = counts[part].data();
        for (Long front = cut[part]; front < cut[part + 1]; front++)
        {
            const Long most = std::max(end - n1rows - rows[front], Long(0));
            fronts.each_column(front, [=](Long j, const double *entries, Long length) {
                own[j] += std::min(length, most) - std::count(entries, entries + std::min(length, most), 0.0);
            });
        }
    });
    for (const std::vector<Long> &part : counts)
        for (std::size_t j = 0; j < n; j++)
            counts_of_all[j] += part[j];
}

// One output matrix: the next free place of each column, and rows and values of the entries.
struct Columns
{
    Long *next;
    Long *row;
    double *value;
};

// Copies the nonzero entries in rows before `end`: columns before n2 to `a`, the others to `b`.
void convert(const Fronts &fronts, Long n1rows, Long end, Long n2, const Columns &a, const Columns &b)
{
    const std::size_t parts = parts_of_all();
    const Long n = fronts.symbolic.n;
    const std::vector<Long> rows = fronts.first_rows();
    // a.next still holds the starts of the columns; their lengths determine the shares.
    std::vector<Long> starts(a.next, a.next + n2 + 1);
    for (Long &at : starts)
        at -= a.next[0];
    const std::vector<Long> cut = cuts(starts, parts);
    share_all(parts, [&](std::size_t part) {
        // The last share also copies the columns of `b`, which are few.
        const Long from = cut[part], to = part + 1 == parts ? n : cut[part + 1];
        for (Long front = 0; front < fronts.symbolic.nf; front++)
        {
            const Long first = n1rows + rows[front];
            fronts.each_column(front, [&, first](Long j, const double *entries, Long length) {
                if (j < from || j >= to)
                    return;
                const Columns &out = j < n2 ? a : b;
                Long &next = out.next[j < n2 ? j : j - n2];
                Long at = next;
                for (Long i = 0; i < std::min(length, end - first); i++)
                    if (entries[i] != 0.0)
                    {
                        out.row[at] = first + i;
                        out.value[at++] = entries[i];
                    }
                next = at;
            });
        }
    });
}

} // namespace

extern "C" void qless_result_count(void *symbolic_in, void *numeric_in, Long n1rows, Long econ, Long n2, int transpose, Long *a,
                                   Long *b, Long *h, Long *vectors)
{
    spqr_symbolic *symbolic = static_cast<spqr_symbolic *>(symbolic_in);
    Numeric *numeric = static_cast<Numeric *>(numeric_in);
    if (qless::has_tree(numeric) && !numeric->keepH && !transpose)
    {
        try
        {
            std::vector<Long> counts(symbolic->n);
            count(Fronts{*symbolic, *numeric}, n1rows, econ, counts);
            for (Long j = 0; j < symbolic->n; j++)
                if (Long *to = j < n2 ? a : b)
                    to[j < n2 ? j : j - n2] += counts[j];
            return;
        }
        catch (...)
        {
            // Out of memory; nothing was added.
        }
    }
    static const Count library = own<Count>("_Z11spqr_rcountIdEvP13spqr_symbolicP12spqr_numericIT_EllliPlS6_S6_S6_");
    library(symbolic, numeric, n1rows, econ, n2, transpose, a, b, h, vectors);
}

extern "C" void qless_result_convert(void *symbolic_in, void *numeric_in, Long n1rows, Long econ, Long n2, int transpose, Long *ap,
                                     Long *ai, double *ax, Long *bp, Long *bi, double *bx, Long *hp, Long *hi, double *hx,
                                     double *htau)
{
    spqr_symbolic *symbolic = static_cast<spqr_symbolic *>(symbolic_in);
    Numeric *numeric = static_cast<Numeric *>(numeric_in);
    if (qless::has_tree(numeric) && !numeric->keepH && !transpose && ap && (bp || n2 == symbolic->n))
    {
        try
        {
            convert(Fronts{*symbolic, *numeric}, n1rows, econ, n2, Columns{ap, ai, ax}, Columns{bp, bi, bx});
            copies++;
            return;
        }
        catch (...)
        {
            // Out of memory; nothing was copied.
        }
    }
    static const Convert library = own<Convert>(
        "_Z13spqr_rconvertIdEvP13spqr_symbolicP12spqr_numericIT_EllliPlS6_PS3_S6_S6_S7_S6_S6_S7_S7_");
    library(symbolic, numeric, n1rows, econ, n2, transpose, ap, ai, ax, bp, bi, bx, hp, hi, hx, htau);
}

extern "C" unsigned long long qless_result_copies()
{
    return copies;
}
