// A periodic plate of springs with Eigen: condense K, solve with SimplicialLDLT, expand; compared with a dense solution of
// [K C^T; C 0] (u, lambda) = (f, b) for the independent equations and prescribed DOFs.
#include <cstdio>
#include <cstdlib>

#include <Eigen/Dense>
#include <Eigen/Sparse>

#include "qless.hpp"

using Vector = Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>; // compressed columns with 32-bit indices

constexpr int N = 8, DOFS = 2 * N * N;

static int dof(int i, int j, int direction) { return 2 * (i + N * j) + direction; }

// Two neighbours with a stiffness along their line, a smaller one across it.
static void add_spring(std::vector<Eigen::Triplet<double>> &k, int a, int b, int along)
{
    for (int d = 0; d < 2; ++d) {
        const double stiffness = d == along ? 3 + 0.1 * (a % 7) : 1;
        for (const auto &[i, j, sign] : {std::tuple{a, a, 1}, {a, b, -1}, {b, a, -1}, {b, b, 1}})
            k.emplace_back(2 * i + d, 2 * j + d, sign * stiffness);
    }
}

static Sparse stiffness()
{
    std::vector<Eigen::Triplet<double>> entries;
    for (int j = 0; j < N; ++j)
        for (int i = 0; i < N; ++i) {
            if (i + 1 < N)
                add_spring(entries, i + N * j, i + 1 + N * j, 0);
            if (j + 1 < N)
                add_spring(entries, i + N * j, i + N * (j + 1), 1);
        }
    Sparse k(DOFS, DOFS);
    k.setFromTriplets(entries.begin(), entries.end());
    k.makeCompressed();
    return k;
}

// Opposite sides move alike, up to a stretch; corners are tied twice, so that two equations are redundant.
static void ties(std::vector<int> &starts, std::vector<int> &columns, std::vector<double> &values, std::vector<double> &b)
{
    starts.push_back(0);
    for (int side = 0; side < 2; ++side)
        for (int a = 0; a < N; ++a)
            for (int d = 0; d < 2; ++d) {
                columns.push_back(side == 0 ? dof(N - 1, a, d) : dof(a, N - 1, d));
                columns.push_back(side == 0 ? dof(0, a, d) : dof(a, 0, d));
                values.insert(values.end(), {1, -1});
                b.push_back(side == d ? 0.01 : 0);
                starts.push_back(static_cast<int>(columns.size()));
            }
}

static void need(bool condition, const char *what)
{
    if (!condition) {
        std::fprintf(stderr, "%s\n", what);
        std::exit(1);
    }
}

int main()
{
    std::vector<int> starts, columns;
    std::vector<double> values, b;
    ties(starts, columns, values, b);
    const std::vector<int> held{dof(0, 0, 0), dof(0, 0, 1)};
    const Sparse k = stiffness();
    Vector f = Vector::Zero(DOFS);
    for (int j = 0; j < DOFS; ++j)
        f[j] = j % 5 - 2.0;

    const qless::Analysis analysis(qless::Rows<int>{DOFS, starts, columns, values}, b, held, std::vector<double>{0.1, -0.2});
    need(analysis.redundant() == 2 && analysis.conflicting() == 0, "two redundant ties");
    qless::Elimination elimination(analysis);

    // K_q in the arrays of Eigen: compressed columns, the lower half.
    const Sparse lower = k.triangularView<Eigen::Lower>();
    const qless::Span<const int> outer(lower.outerIndexPtr(), DOFS + 1), inner(lower.innerIndexPtr(), lower.nonZeros());
    const qless::Pattern pattern(elimination, qless::Lines<int>{outer, inner, QLESS_COLUMNS, QLESS_LOWER});
    Sparse k_q(pattern.unknowns(), pattern.unknowns());
    k_q.resizeNonZeros(pattern.entries());
    std::vector<int> dofs(static_cast<std::size_t>(pattern.unknowns()));
    pattern.arrays<int>({k_q.outerIndexPtr(), pattern.unknowns() + 1}, {k_q.innerIndexPtr(), pattern.entries()}, dofs);
    Vector f_q(k_q.cols()), u(DOFS), lambda(analysis.equations()), reactions(2);
    const qless::Span<const double> k_values(lower.valuePtr(), lower.nonZeros());

    Eigen::SimplicialLDLT<Sparse, Eigen::Lower> ldlt;
    ldlt.analyzePattern(k_q);
    for (const double stretch : {1.0, 3.0}) { // the pattern is made once
        std::vector<double> rhs = b;
        for (double &side : rhs)
            side *= stretch;
        elimination.refresh(rhs, std::vector<double>{0.1 * stretch, -0.2});
        pattern.condense(k_values, f, {k_q.valuePtr(), k_q.nonZeros()}, f_q);
        ldlt.factorize(k_q);
        elimination.expand(Vector(ldlt.solve(f_q)), u);
        const Vector residual = f - k * u;
        elimination.multipliers(residual, lambda);
        elimination.reactions(residual, lambda, reactions);

        // The dense reference, with prescribed DOFs as equations.
        const auto kinds = analysis.kinds();
        Eigen::MatrixXd c = Eigen::MatrixXd::Zero(analysis.rank() + 2, DOFS);
        Vector d(c.rows());
        int row = 0;
        for (int i = 0; i < analysis.equations(); ++i)
            if (kinds[i] == QLESS_INDEPENDENT) {
                for (int e = starts[i]; e < starts[i + 1]; ++e)
                    c(row, columns[e]) += values[e];
                d[row++] = rhs[i];
            }
        c(row, held[0]) = c(row + 1, held[1]) = 1;
        d.tail(2) << 0.1 * stretch, -0.2;
        Eigen::MatrixXd saddle = Eigen::MatrixXd::Zero(DOFS + c.rows(), DOFS + c.rows());
        saddle << Eigen::MatrixXd(k), c.transpose(), c, Eigen::MatrixXd::Zero(c.rows(), c.rows());
        const Vector all = saddle.fullPivLu().solve((Vector(DOFS + c.rows()) << f, d).finished());

        if (stretch == 1)
            std::printf("%d masters, |u| = %.9f, largest %.9f\n", int(k_q.cols()), u.norm(), u.lpNorm<Eigen::Infinity>());
        const double size = u.lpNorm<Eigen::Infinity>(), force = (k * u).lpNorm<Eigen::Infinity>();
        need((u - all.head(DOFS)).lpNorm<Eigen::Infinity>() < 1e-10 * size, "u as with multipliers");
        need((c * u - d).lpNorm<Eigen::Infinity>() < 1e-10 * size, "C u = b");
        need((reactions + all.tail(2)).lpNorm<Eigen::Infinity>() < 1e-10 * force, "reactions as with multipliers");
        Vector left = residual;
        for (int i = 0; i < analysis.equations(); ++i)
            for (int e = starts[i]; e < starts[i + 1]; ++e)
                left[columns[e]] -= values[e] * lambda[i];
        left[held[0]] += reactions[0], left[held[1]] += reactions[1];
        need(left.lpNorm<Eigen::Infinity>() < 1e-10 * force, "K u + C^T lambda = f + reactions");
    }
}
