// The C++ header: owners, spans, exceptions; 32- and 64-bit indices from 0 and from 1.
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

int main()
{
    solve<std::int32_t>(0);
    solve<std::int64_t>(1);
    std::puts("owners: as expected");
}
