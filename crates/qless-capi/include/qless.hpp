// qless for C++17: owners of the handles of qless.h, spans of the caller's arrays, exceptions instead of statuses.
//
//     qless::Analysis analysis(qless::Rows<int>{3, starts, columns, values}, rhs);
//     if (analysis.conflicting() == 0) {
//         qless::Elimination elimination(analysis);
//         elimination.expand(masters, u);
//     }
//     qless::Deck("model.inp").clean("mended.inp");
//
// A span is anything with data() and size(): std::vector, std::array, Eigen::VectorXd, std::span.
#ifndef QLESS_HPP
#define QLESS_HPP

#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
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
    // QLESS_INPUT, QLESS_CONFLICT, QLESS_NUMERICAL, QLESS_INTERNAL, QLESS_FILE or QLESS_RANKS.
    int status() const noexcept { return status_; }

private:
    int status_;
};

namespace detail {

inline int need(int status)
{
    if (status < 0)
        throw Error(status);
    return status;
}

// A text of the library: `call(text, room, &length)`.
template <class Call> std::string text(Call call)
{
    std::int64_t length = 0;
    need(call(nullptr, 0, &length));
    std::string text(static_cast<std::size_t>(length), '\0');
    need(call(text.data(), length, &length));
    text.pop_back();
    return text;
}

struct FreeHandle {
    void operator()(qless_options *handle) const noexcept { qless_options_free(handle); }
    void operator()(qless_analysis *handle) const noexcept { qless_analysis_free(handle); }
    void operator()(qless_elimination *handle) const noexcept { qless_elimination_free(handle); }
    void operator()(qless_pattern *handle) const noexcept { qless_pattern_free(handle); }
    void operator()(qless_deck *handle) const noexcept { qless_deck_free(handle); }
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

// A free DOF that the equations fix.
struct Fixed {
    std::int64_t dof;
    double value;
};

// Equations and prescribed values whose sum is a dependent equation or the value `rhs` of a fixed DOF.
struct Reason {
    std::vector<qless_member> members;
    double rhs;
    // No member can be left out; false if that is not known.
    bool is_irreducible;
};

// Ways to cure conflicts that have numbers in common, the most plausible way first.
struct Repair {
    std::vector<std::int64_t> conflicts;
    std::vector<std::vector<qless_change>> ways;
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
        take(made, c.base);
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

    // Why an equation is dependent (QLESS_EQUATION) or a DOF fixed (QLESS_DOF), in few equations and prescribed values.
    Reason reason(int what, std::int64_t index) const
    {
        Reason reason{};
        int irreducible = 0;
        std::int64_t count = 0;
        detail::need(qless_reason(get(), what, index, nullptr, 0, &reason.rhs, &irreducible, &count));
        reason.members.resize(static_cast<std::size_t>(count));
        detail::need(qless_reason(get(), what, index, reason.members.data(), count, &reason.rhs, &irreducible, &count));
        reason.is_irreducible = irreducible != 0;
        return reason;
    }

    // The free DOFs that the equations fix.
    std::vector<Fixed> fixed() const
    {
        std::int64_t count = 0;
        detail::need(qless_fixed_64(get(), nullptr, nullptr, 0, &count));
        std::vector<std::int64_t> dofs(static_cast<std::size_t>(count));
        std::vector<double> values(dofs.size());
        detail::need(qless_fixed_64(get(), dofs.data(), values.data(), count, &count));
        std::vector<Fixed> fixed;
        for (std::size_t k = 0; k < dofs.size(); ++k)
            fixed.push_back({dofs[k], values[k]});
        return fixed;
    }

    // What to change so that no conflict is left.
    std::vector<Repair> repairs() const
    {
        std::int64_t groups = 0, conflicts = 0, ways = 0, changes = 0;
        detail::need(qless_repairs(get(), &groups));
        std::vector<Repair> repairs;
        for (std::int64_t g = base_; g < groups + base_; ++g) {
            detail::need(qless_repair_sizes(get(), g, &conflicts, &ways, &changes));
            Repair repair;
            repair.conflicts.resize(static_cast<std::size_t>(conflicts));
            detail::need(qless_repair_conflicts(get(), g, repair.conflicts.data(), conflicts));
            for (std::int64_t w = base_; w < ways + base_; ++w) {
                repair.ways.emplace_back(static_cast<std::size_t>(changes));
                detail::need(qless_repair(get(), g, w, repair.ways.back().data(), changes));
            }
            repairs.push_back(std::move(repair));
        }
        return repairs;
    }

    // Why the verdict is ambiguous: QLESS_NO_DOUBT or a doubt, and a line for each reason.
    std::pair<int, std::string> doubt() const
    {
        int doubt = QLESS_NO_DOUBT;
        std::string text = detail::text([&](char *text, std::int64_t room, std::int64_t *length) {
            return qless_doubt(get(), &doubt, text, room, length);
        });
        return {doubt, std::move(text)};
    }

    // The label of an equation (QLESS_EQUATION) or DOF (QLESS_DOF), or the place of a prescribed value (QLESS_PRESCRIBED).
    std::string label(int what, std::int64_t index) const
    {
        return detail::text([&](char *text, std::int64_t room, std::int64_t *length) {
            return qless_label(get(), what, index, text, room, length);
        });
    }

    const qless_analysis *get() const noexcept { return handle_.get(); }

private:
    friend class Deck;
    Analysis(qless_analysis *made, int base) { take(made, base); }

    void take(qless_analysis *made, int base)
    {
        handle_.reset(made);
        base_ = base;
        detail::need(qless_counts(made, &equations_, &dofs_, &rank_, &redundant_, &conflicting_));
    }

    detail::Owner<qless_analysis> handle_;
    int base_ = 0;
    std::int64_t equations_ = 0, dofs_ = 0, rank_ = 0, redundant_ = 0, conflicting_ = 0;
};

// A deck of CalculiX, Abaqus, Nastran or ANSYS.
class Deck {
public:
    explicit Deck(const std::string &path, const char *solver = nullptr, int base = 0) : base_(base)
    {
        qless_deck *made = nullptr;
        is_incomplete_ = detail::need(qless_deck_read(path.c_str(), solver, base, &made)) == QLESS_INCOMPLETE;
        handle_.reset(made);
        std::int64_t left_out;
        detail::need(qless_deck_counts(made, &equations_, &load_cases_, &warnings_, &left_out));
    }

    std::int64_t equations() const noexcept { return equations_; }
    // Whether constraints were left out; the first warnings name them.
    bool is_incomplete() const noexcept { return is_incomplete_; }
    // Names of the load cases.
    std::vector<std::string> load_cases() const { return texts(qless_deck_load_case, load_cases_); }
    std::vector<std::string> warnings() const { return texts(qless_deck_warning, warnings_); }

    // The diagnosis of a load case; -1 for any, if all constrain the same.
    Analysis analyse(std::int64_t load_case = -1, const Options *options = nullptr) const
    {
        qless_analysis *made = nullptr;
        detail::need(qless_deck_analyse(handle_.get(), load_case, options == nullptr ? nullptr : options->get(), &made));
        return Analysis(made, base_);
    }

    // Writes the deck with an independent set of constraints.
    void clean(const std::string &path, const Options *options = nullptr) const
    {
        const qless_options *given = options == nullptr ? nullptr : options->get();
        detail::need(qless_deck_clean(handle_.get(), given, path.c_str(), nullptr, nullptr));
    }

    const qless_deck *get() const noexcept { return handle_.get(); }

private:
    using Text = int (*)(const qless_deck *, std::int64_t, char *, std::int64_t, std::int64_t *);

    std::vector<std::string> texts(Text call, std::int64_t count) const
    {
        std::vector<std::string> texts;
        for (std::int64_t k = base_; k < count + base_; ++k)
            texts.push_back(detail::text([&](char *text, std::int64_t room, std::int64_t *length) {
                return call(handle_.get(), k, text, room, length);
            }));
        return texts;
    }

    detail::Owner<qless_deck> handle_;
    int base_;
    bool is_incomplete_;
    std::int64_t equations_ = 0, load_cases_ = 0, warnings_ = 0;
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

    // Reactions C^T lambda - (f - K u) at the prescribed DOFs.
    void reactions(Span<const double> residual, Span<const double> lambda, Span<double> reactions) const
    {
        detail::need(qless_reactions(handle_.get(), residual.data(), residual.size(), lambda.data(), lambda.size(), reactions.data(),
                                     reactions.size()));
    }

    // New b and prescribed values; true if another rank or verdict is possible for them.
    bool refresh(Span<const double> rhs, Span<const double> prescribed = {})
    {
        return QLESS_AMBIGUOUS == detail::need(qless_refresh(handle_.get(), rhs.data(), rhs.size(), prescribed.data(), prescribed.size()));
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

// The pattern of a matrix K by lines, which are QLESS_ROWS or QLESS_COLUMNS, with indices from the base of the elimination.
template <class Integer> struct Lines {
    Span<const Integer> starts, index;
    int lines = QLESS_ROWS;
    int storage = QLESS_FULL;
};

// The pattern of K_q = L^T K L, computed once, and the values in every step. It keeps its elimination.
class Pattern {
public:
    template <class Integer>
    Pattern(const Elimination &elimination, const Lines<Integer> &k, int prescribed = QLESS_ELIMINATED)
    {
        const std::int64_t dofs = k.starts.size() - 1;
        qless_pattern *made = nullptr;
        if constexpr (std::is_same_v<Integer, std::int32_t>)
            detail::need(qless_condensed(elimination.get(), dofs, k.lines, k.storage, prescribed, k.starts.data(), k.index.data(), &made));
        else
            detail::need(
                qless_condensed_64(elimination.get(), dofs, k.lines, k.storage, prescribed, k.starts.data(), k.index.data(), &made));
        take(made);
    }

    // For elements, by rows: element e has the DOFs dofs[starts[e]] .. dofs[starts[e + 1]].
    template <class Integer>
    static Pattern of_elements(const Elimination &elimination, Span<const Integer> starts, Span<const Integer> dofs,
                               int storage = QLESS_FULL, int prescribed = QLESS_ELIMINATED)
    {
        const std::int64_t elements = starts.size() - 1;
        qless_pattern *made = nullptr;
        if constexpr (std::is_same_v<Integer, std::int32_t>)
            detail::need(qless_condensed_for_elements(elimination.get(), elements, storage, prescribed, starts.data(), dofs.data(), &made));
        else
            detail::need(
                qless_condensed_for_elements_64(elimination.get(), elements, storage, prescribed, starts.data(), dofs.data(), &made));
        return Pattern(made);
    }

    std::int64_t unknowns() const noexcept { return unknowns_; }
    std::int64_t entries() const noexcept { return entries_; }

    // Lines of K_q, and the DOF of each unknown.
    template <class Integer> void arrays(Span<Integer> starts, Span<Integer> index, Span<Integer> dofs) const
    {
        if (starts.size() != unknowns_ + 1 || index.size() != entries_ || dofs.size() != unknowns_)
            throw std::invalid_argument("qless: the lengths of the arrays are not those of the pattern");
        if constexpr (std::is_same_v<Integer, std::int32_t>)
            detail::need(qless_pattern_arrays(handle_.get(), starts.data(), index.data(), dofs.data()));
        else
            detail::need(qless_pattern_arrays_64(handle_.get(), starts.data(), index.data(), dofs.data()));
    }

    // K_q = L^T K L.
    void condense(Span<const double> k, Span<double> k_q) const { condense(k, {}, k_q, {}); }
    // K_q = L^T K L and f_q = L^T (f - K u_0).
    void condense(Span<const double> k, Span<const double> f, Span<double> k_q, Span<double> f_q) const
    {
        detail::need(qless_condense(handle_.get(), k.data(), k.size(), f.data(), f.size(), k_q.data(), k_q.size(), f_q.data(), f_q.size()));
    }

    // K_q and f_q from all elements: `element(e, matrix, forces)` adds K_e by rows and f_e to zeros, on several threads at once. An
    // exception of it ends the assembly and is thrown again.
    template <class Element> void assemble(Element element, Span<double> k_q, Span<double> f_q) const
    {
        struct Context {
            Element &element;
            std::mutex mutex;
            std::exception_ptr thrown;
        } context{element, {}, {}};
        const qless_element call = [](void *given, std::int64_t e, double *matrix, double *forces) {
            auto &context = *static_cast<Context *>(given);
            try {
                context.element(e, matrix, forces);
                return 0;
            } catch (...) {
                const std::lock_guard<std::mutex> lock(context.mutex);
                context.thrown = std::current_exception();
                return 1;
            }
        };
        const int status = qless_assemble(handle_.get(), call, &context, k_q.data(), k_q.size(), f_q.data(), f_q.size());
        if (context.thrown)
            std::rethrow_exception(context.thrown);
        detail::need(status);
    }

    // Adds one element, with its matrix by rows, to K_q and f_q.
    template <class Integer>
    void add_element(Span<const Integer> dofs, Span<const double> matrix, Span<const double> forces, Span<double> k_q,
                     Span<double> f_q) const
    {
        if (matrix.size() != dofs.size() * dofs.size() || forces.size() != dofs.size())
            throw std::invalid_argument("qless: the lengths of the arrays of the element do not agree");
        if constexpr (std::is_same_v<Integer, std::int32_t>)
            detail::need(qless_add_element(handle_.get(), dofs.size(), dofs.data(), matrix.data(), forces.data(), k_q.data(), k_q.size(),
                                           f_q.data(), f_q.size()));
        else
            detail::need(qless_add_element_64(handle_.get(), dofs.size(), dofs.data(), matrix.data(), forces.data(), k_q.data(),
                                              k_q.size(), f_q.data(), f_q.size()));
    }

private:
    explicit Pattern(qless_pattern *made) { take(made); }

    void take(qless_pattern *made)
    {
        handle_.reset(made);
        detail::need(qless_pattern_sizes(made, &unknowns_, &entries_));
    }

    detail::Owner<qless_pattern> handle_;
    std::int64_t unknowns_ = 0, entries_ = 0;
};

} // namespace qless

#endif
