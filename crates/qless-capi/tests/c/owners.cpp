// The C++ header: owners, spans, exceptions; 32- and 64-bit indices from 0 and from 1.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "qless.hpp"

#define NEED(condition)                                                        \
    do {                                                                       \
        if (!(condition)) {                                                    \
            std::fprintf(stderr, "line %d: %s\n", __LINE__, #condition);       \
            std::exit(1);                                                      \
        }                                                                      \
    } while (0)

using Ends = std::vector<int>;
using Value = std::vector<double>;

template <class Integer> void solve(int base)
{
    // u0 - u1 = u3, 2 u0 - 2 u1 = 2 u3, u1 - u2 = 0.5; u3 is prescribed.
    std::vector<Integer> starts{0, 3, 6, 8}, columns{0, 1, 3, 0, 1, 3, 1, 2}, given{3};
    for (auto *list : {&starts, &columns, &given})
        for (Integer &k : *list)
            k += static_cast<Integer>(base);
    const std::vector<double> values{1, -1, -1, 2, -2, -2, 1, -1}, rhs{0, 0, 0.5}, value{0.25};
    qless::Options options;
    options.set("growth", 2.0).set("backend", "sparse");
    qless::Analysis analysis(qless::Rows<Integer>{4, starts, columns, values, base}, rhs, given, value, &options);
    NEED(analysis.rank() == 2 && analysis.redundant() == 1 && analysis.conflicting() == 0 && !analysis.is_ambiguous());
    NEED((analysis.kinds() == std::vector<std::int8_t>{0, 1, 0}));
    const auto because = analysis.because(1 + base);
    NEED(because.size() == 1 && because[0].row == base && because[0].coefficient == 2);

    qless::Elimination elimination(analysis);
    qless::Elimination moved = std::move(elimination);
    std::array<double, 4> u{}, forces{1, 1, 1, 1};
    std::array<double, 1> master{7};
    moved.expand(master, u);
    NEED(u[0] - u[1] == 0.25 && u[1] - u[2] == 0.5 && u[3] == 0.25);
    moved.restrict_to_masters(forces, master);
    NEED(master[0] == 3);
    moved.refresh(std::vector<double>{1, 2, 0}, std::vector<double>{0});
    moved.expand(master, u);
    NEED(std::abs(u[0] - u[1] - 1) < 1e-15);
    const qless::Matrix t = moved.t(), g = moved.g_matrix();
    NEED(t.starts.size() == 3 && t.starts[0] == base && t.values.size() == 2 && g.values.size() + 1 >= 1 && moved.g().size() == 2);
    std::array<double, 3> lambda{};
    moved.multipliers(forces, lambda);
    NEED(lambda[1] == 0);

    try {
        moved.refresh(std::vector<double>{1, 3, 0}, std::vector<double>{0});
        NEED(false);
    } catch (const qless::Error &error) {
        NEED(error.status() == QLESS_CONFLICT);
    }
    try {
        qless::Analysis(qless::Rows<Integer>{4, starts, columns, rhs, base});
        NEED(false);
    } catch (const std::invalid_argument &) {
    }
}

// A chain of three springs whose ends are tied: by K, and by its elements.
template <class Integer> void condense(int base)
{
    std::vector<Integer> starts{0, 2}, columns{3, 0}, given{1}, ends{0, 2, 4, 6}, of{0, 1, 1, 2, 2, 3};
    std::vector<Integer> k_starts{0, 2, 5, 8, 10}, k_index{0, 1, 0, 1, 2, 1, 2, 3, 2, 3};
    for (auto *list : {&starts, &columns, &given, &ends, &of, &k_starts, &k_index})
        for (Integer &k : *list)
            k += static_cast<Integer>(base);
    const std::vector<double> tie{1, -1}, one{1}, k{1, -1, -1, 2, -1, -1, 2, -1, -1, 1}, f(4);
    const qless::Analysis analysis(qless::Rows<Integer>{4, starts, columns, tie, base}, {}, given, one);
    const qless::Elimination elimination(analysis);
    const qless::Pattern pattern(elimination, qless::Lines<Integer>{k_starts, k_index});
    NEED(pattern.unknowns() == 2 && pattern.entries() == 4);
    std::vector<Integer> q_starts(3), q_index(4), dofs(2);
    pattern.arrays<Integer>(q_starts, q_index, dofs);
    NEED(q_starts[2] == 4 + base && q_index[1] == 1 + base && dofs[1] > dofs[0]);
    std::vector<double> k_q(4), alone(4), added(4), f_q(2), of_elements(2);
    pattern.condense(k, f, k_q, f_q);
    pattern.condense(k, alone);
    NEED(k_q == alone && (f_q == std::vector<double>{1, 1}));

    const qless::Pattern assembled = qless::Pattern::of_elements<Integer>(elimination, ends, of);
    std::int64_t sum = 0;
    const auto spring = [&](std::int64_t e, double *matrix, double *) {
        sum += e;
        matrix[0] = matrix[3] = 1, matrix[1] = matrix[2] = -1;
    };
    assembled.assemble(spring, added, of_elements);
    NEED(added == k_q && of_elements == f_q && sum == 3 + 3 * base);
    std::fill(added.begin(), added.end(), 0), std::fill(f_q.begin(), f_q.end(), 0);
    for (std::size_t e = 0; e < 3; ++e)
        assembled.add_element<Integer>({of.data() + 2 * e, 2}, std::vector<double>{1, -1, -1, 1}, std::vector<double>(2), added, f_q);
    NEED(added == k_q && of_elements == f_q);
    try {
        assembled.assemble([](std::int64_t, double *, double *) { throw std::out_of_range("no such element"); }, added, f_q);
        NEED(false);
    } catch (const std::out_of_range &) {
    }
}

// The reason of a sum of 160 equations, the last one times `last`.
qless::Reason long_reason(double last)
{
    const int n = 160;
    std::vector<int> starts{0}, columns;
    std::vector<double> values;
    const auto row = [&](int i, double factor) {
        for (int k = 0; k < 3; ++k)
            columns.push_back(i + k), values.push_back(factor * (k == 1 ? 4 : 1));
    };
    for (int i = 0; i < n; ++i)
        row(i, 1), starts.push_back(3 * i + 3);
    for (int i = 0; i < n; ++i)
        row(i, i + 1 < n ? 1 : last);
    starts.push_back(6 * n);
    const qless::Analysis analysis(qless::Rows<int>{n + 2, starts, columns, values});
    const std::vector<std::int8_t> kinds = analysis.kinds();
    const auto dependent = std::find(kinds.begin(), kinds.end(), QLESS_REDUNDANT);
    return analysis.reason(QLESS_EQUATION, dependent - kinds.begin());
}

void explain()
{
    // u0 = u1 = u2, and the ends are prescribed.
    const std::vector<int> starts{0, 2, 4}, columns{0, 1, 1, 2}, ends{0, 2};
    const std::vector<double> values{1, -1, 1, -1}, given{0.5, 0};
    const qless::Analysis analysis(qless::Rows<int>{3, starts, columns, values}, {}, ends, given);
    NEED(analysis.conflicting() == 1 && analysis.fixed().size() == 1 && analysis.fixed()[0].dof == 1);
    const qless::Reason reason = analysis.reason(QLESS_EQUATION, 1);
    NEED(reason.members.size() == 3 && reason.members[2].what == QLESS_PRESCRIBED && reason.rhs == 0.5 && reason.is_irreducible);
    NEED(!long_reason(std::ldexp(1.0, -27)).is_irreducible && long_reason(1).is_irreducible && long_reason(1).members.size() == 160);
    const std::vector<qless::Repair> repairs = analysis.repairs();
    NEED(repairs.size() == 1 && repairs[0].conflicts == std::vector<std::int64_t>{1} && repairs[0].ways.size() == 4);
    NEED(repairs[0].ways[0].size() == 1 && repairs[0].ways[0][0].what == QLESS_PRESCRIBED);
    NEED(analysis.doubt().first == QLESS_NO_DOUBT && analysis.doubt().second.empty() && analysis.label(QLESS_DOF, 2) == "DOF 3");
    const qless::Elimination elimination(qless::Analysis(qless::Rows<int>{3, starts, columns, values}, {}, Ends{0}, Value{0.5}));
    std::vector<double> residual{1, 1, 1}, lambda(2), reactions(1);
    elimination.multipliers(residual, lambda);
    elimination.reactions(residual, lambda, reactions);
    NEED(reactions[0] == -3);
}

void clean_a_deck()
{
    const qless::Deck deck(DECK);
    NEED(deck.equations() == 3 && !deck.is_incomplete() && deck.load_cases().size() == 1 && deck.warnings().empty());
    const qless::Analysis analysis = deck.analyse();
    NEED(analysis.redundant() == 1 && analysis.label(QLESS_EQUATION, 2) == "line 13 *EQUATION 1:1");
    try {
        deck.clean("no/such/folder.inp");
        NEED(false);
    } catch (const qless::Error &error) {
        NEED(error.status() == QLESS_FILE);
    }
}

int main()
{
    solve<std::int32_t>(0);
    solve<std::int64_t>(1);
    condense<std::int32_t>(1);
    condense<std::int64_t>(0);
    explain();
    clean_a_deck();
    std::puts("owners: as expected");
}
