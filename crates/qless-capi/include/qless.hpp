// qless for C++17: owners of the handles of qless.h, spans of the caller's arrays, exceptions instead of statuses.
//
//     qless::Analysis analysis(qless::Rows<int>{3, starts, columns, values}, rhs);
//     if (analysis.conflicting() == 0) {
//         qless::Elimination elimination(analysis);
//         elimination.expand(masters, u);
//     }
//
// A span is anything with data() and size(): std::vector, std::array, Eigen::VectorXd, std::span.
#ifndef QLESS_HPP
#define QLESS_HPP

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "qless.h"

namespace qless {

// A call that failed.
class Error : public std::runtime_error {
public:
    explicit Error(int status) : std::runtime_error(qless_message()), status_(status) {}
    // QLESS_INPUT, QLESS_CONFLICT, QLESS_NUMERICAL or QLESS_INTERNAL.
    int status() const noexcept { return status_; }

private:
    int status_;
};

namespace detail {

inline void need(int status)
{
    if (status < 0)
        throw Error(status);
}

struct FreeHandle {
    void operator()(qless_options *handle) const noexcept { qless_options_free(handle); }
    void operator()(qless_analysis *handle) const noexcept { qless_analysis_free(handle); }
    void operator()(qless_elimination *handle) const noexcept { qless_elimination_free(handle); }
};

template <class Handle> using Owner = std::unique_ptr<Handle, FreeHandle>;

} // namespace detail

// A view of the caller's numbers, which must live until the call that takes it returns.
template <class T> class Span {
public:
    Span() noexcept : data_(nullptr), size_(0) {}
    Span(T *data, std::int64_t size) noexcept : data_(data), size_(size) {}
    template <class List, class = std::enable_if_t<std::is_convertible_v<decltype(std::declval<List &>().data()), T *>>>
    Span(List &&list) : data_(list.data()), size_(static_cast<std::int64_t>(list.size())) {}
    T *data() const noexcept { return data_; }
    std::int64_t size() const noexcept { return size_; }

private:
    T *data_;
    std::int64_t size_;
};

// C in compressed rows over `dofs` columns; indices are 32- or 64-bit, from 0 or from 1.
template <class Integer> struct Rows {
    static_assert(std::is_same_v<Integer, std::int32_t> || std::is_same_v<Integer, std::int64_t>, "indices have 32 or 64 bits");
    std::int64_t dofs;
    Span<const Integer> starts, columns;
    Span<const double> values;
    int base = 0;
};

// A sparse matrix in compressed rows.
struct Matrix {
    std::vector<std::int64_t> starts, columns;
    std::vector<double> values;
};

class Options {
public:
    Options()
    {
        qless_options *made = nullptr;
        detail::need(qless_options_create(&made));
        handle_.reset(made);
    }
    Options &set(const std::string &name, double value)
    {
        detail::need(qless_options_set_number(handle_.get(), name.c_str(), value));
        return *this;
    }
    Options &set(const std::string &name, const char *value)
    {
        detail::need(qless_options_set_word(handle_.get(), name.c_str(), value));
        return *this;
    }
    const qless_options *get() const noexcept { return handle_.get(); }

private:
    detail::Owner<qless_options> handle_;
};

// (row, coefficient) of an equation that explains another.
struct Term {
    std::int64_t row;
    double coefficient;
};

// The diagnosis. Without rhs, b is zero.
class Analysis {
public:
    template <class Integer>
    explicit Analysis(const Rows<Integer> &c, Span<const double> rhs = {}, Span<const std::common_type_t<Integer>> prescribed = {},
                      Span<const double> prescribed_values = {}, const Options *options = nullptr)
    {
        const std::int64_t equations = c.starts.size() - 1;
        const bool fits = equations >= 0 && c.columns.size() == c.values.size() && prescribed.size() == prescribed_values.size() &&
                          (rhs.data() == nullptr || rhs.size() == equations) && c.columns.size() == c.starts.data()[equations] - c.base;
        if (!fits)
            throw std::invalid_argument("qless: the lengths of the arrays do not agree");
        qless_analysis *made = nullptr;
        const qless_options *given = options == nullptr ? nullptr : options->get();
        if constexpr (std::is_same_v<Integer, std::int32_t>)
            detail::need(qless_analyse(equations, c.dofs, c.base, c.starts.data(), c.columns.data(), c.values.data(), rhs.data(),
                                       prescribed.size(), prescribed.data(), prescribed_values.data(), given, &made));
        else
            detail::need(qless_analyse_64(equations, c.dofs, c.base, c.starts.data(), c.columns.data(), c.values.data(), rhs.data(),
                                          prescribed.size(), prescribed.data(), prescribed_values.data(), given, &made));
        handle_.reset(made);
        detail::need(qless_counts(made, &equations_, &dofs_, &rank_, &redundant_, &conflicting_));
    }

    std::int64_t equations() const noexcept { return equations_; }
    std::int64_t dofs() const noexcept { return dofs_; }
    std::int64_t rank() const noexcept { return rank_; }
    std::int64_t redundant() const noexcept { return redundant_; }
    std::int64_t conflicting() const noexcept { return conflicting_; }

    // QLESS_INDEPENDENT, QLESS_REDUNDANT or QLESS_CONFLICTING for each equation.
    std::vector<std::int8_t> kinds() const
    {
        std::vector<std::int8_t> kinds(static_cast<std::size_t>(equations_));
        detail::need(qless_kinds(get(), kinds.data(), equations_));
        return kinds;
    }

    bool is_ambiguous() const
    {
        double kept, dropped;
        int ambiguous;
        detail::need(qless_digits(get(), &kept, &dropped, &ambiguous));
        return ambiguous != 0;
    }

    // The equations of which a dependent one is a combination.
    std::vector<Term> because(std::int64_t row) const
    {
        std::int64_t count = 0;
        detail::need(qless_explanation_64(get(), row, nullptr, nullptr, 0, &count));
        std::vector<std::int64_t> rows(static_cast<std::size_t>(count));
        std::vector<double> coefficients(rows.size());
        detail::need(qless_explanation_64(get(), row, rows.data(), coefficients.data(), count, &count));
        std::vector<Term> terms;
        for (std::size_t k = 0; k < rows.size(); ++k)
            terms.push_back({rows[k], coefficients[k]});
        return terms;
    }

    const qless_analysis *get() const noexcept { return handle_.get(); }

private:
    detail::Owner<qless_analysis> handle_;
    std::int64_t equations_ = 0, dofs_ = 0, rank_ = 0, redundant_ = 0, conflicting_ = 0;
};

// The reduced form u_s = T u_q + G u_p + g. It stays valid without the analysis.
class Elimination {
public:
    explicit Elimination(const Analysis &analysis)
    {
        qless_elimination *made = nullptr;
        detail::need(qless_eliminate(analysis.get(), &made));
        handle_.reset(made);
        std::int64_t slaves, masters, prescribed;
        detail::need(qless_sizes(made, &slaves, &masters, &prescribed, &t_entries_, &g_entries_));
        slaves_.resize(static_cast<std::size_t>(slaves));
        masters_.resize(static_cast<std::size_t>(masters));
        prescribed_.resize(static_cast<std::size_t>(prescribed));
        detail::need(qless_dofs_64(made, slaves_.data(), masters_.data(), prescribed_.data()));
    }

    const std::vector<std::int64_t> &slaves() const noexcept { return slaves_; }
    const std::vector<std::int64_t> &masters() const noexcept { return masters_; }
    const std::vector<std::int64_t> &prescribed() const noexcept { return prescribed_; }

    Matrix t() const { return matrix(qless_t_64, t_entries_); }
    Matrix g_matrix() const { return matrix(qless_g_matrix_64, g_entries_); }

    std::vector<double> g() const
    {
        std::vector<double> g(slaves_.size());
        detail::need(qless_g(handle_.get(), g.data(), static_cast<std::int64_t>(g.size())));
        return g;
    }

    // u = L u_q + u_0.
    void expand(Span<const double> masters, Span<double> u) const { apply(qless_expand, masters, u); }
    // du = L du_q.
    void expand_increment(Span<const double> masters, Span<double> du) const { apply(qless_expand_increment, masters, du); }
    // f_q = L^T f.
    void restrict_to_masters(Span<const double> forces, Span<double> masters) const { apply(qless_restrict, forces, masters); }
    // lambda of K u + C^T lambda = f from the residual f - K u.
    void multipliers(Span<const double> residual, Span<double> lambda) const { apply(qless_multipliers, residual, lambda); }

    void refresh(Span<const double> rhs, Span<const double> prescribed = {})
    {
        detail::need(qless_refresh(handle_.get(), rhs.data(), rhs.size(), prescribed.data(), prescribed.size()));
    }

    const qless_elimination *get() const noexcept { return handle_.get(); }

private:
    using Apply = int (*)(const qless_elimination *, const double *, std::int64_t, double *, std::int64_t);
    using Write = int (*)(const qless_elimination *, std::int64_t *, std::int64_t *, double *);

    void apply(Apply call, Span<const double> in, Span<double> out) const
    {
        detail::need(call(handle_.get(), in.data(), in.size(), out.data(), out.size()));
    }

    Matrix matrix(Write call, std::int64_t entries) const
    {
        Matrix matrix;
        matrix.starts.resize(slaves_.size() + 1);
        matrix.columns.resize(static_cast<std::size_t>(entries));
        matrix.values.resize(matrix.columns.size());
        detail::need(call(handle_.get(), matrix.starts.data(), matrix.columns.data(), matrix.values.data()));
        return matrix;
    }

    detail::Owner<qless_elimination> handle_;
    std::vector<std::int64_t> slaves_, masters_, prescribed_;
    std::int64_t t_entries_ = 0, g_entries_ = 0;
};

} // namespace qless

#endif
