// A P = Q R and Q^T B by Eigen's SparseQR, with COLAMD: what the paper calls the solver.
//
// Plain C at the border: no exception crosses it, and what it allocates is freed by qless_eigen_free.
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <Eigen/SparseQR>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <new>
#include <vector>

namespace {

using Sparse = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
using ByRow = Eigen::SparseMatrix<double, Eigen::RowMajor, int>;
using Qr = Eigen::SparseQR<Sparse, Eigen::COLAMDOrdering<int>>;

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

extern "C" {

enum { QLESS_DONE = 0, QLESS_NO_MEMORY = 1, QLESS_FAILED = 2 };

// What one factorization gives; R by rows, `rank` of them.
struct qless_eigen {
    int64_t rank;
    int64_t entries;
    const int *order;
    const int *start;
    const int *column;
    const double *value;
    double compute;
    double extract;
    void *owner;
    char message[128];
};

}  // extern "C"

namespace {

struct Owner {
    ByRow r;
    std::vector<int> order;
};

int factor(int m, int n, const int *start, const int *row, const double *value, int k, double *rhs, double threshold,
           qless_eigen *out) {
    auto from = std::chrono::steady_clock::now();
    const Sparse a = Eigen::Map<const Sparse>(m, n, start[n], start, row, value);
    Qr qr;
    if (threshold >= 0) qr.setPivotThreshold(threshold);
    qr.compute(a);
    if (qr.info() != Eigen::Success) {
        std::snprintf(out->message, sizeof out->message, "%s", qr.lastErrorMessage().c_str());
        return QLESS_FAILED;
    }
    out->compute = seconds_since(from);

    from = std::chrono::steady_clock::now();
    Owner *owner = new Owner;
    out->owner = owner;
    // Its columns are not sorted; by rows they are.
    owner->r = qr.matrixR();
    const auto &p = qr.colsPermutation().indices();
    owner->order.assign(p.data(), p.data() + p.size());
    Eigen::Map<Eigen::MatrixXd> b(rhs, m, k);
    const Eigen::MatrixXd turned = qr.matrixQ().adjoint() * b;
    b = turned;
    out->rank = qr.rank();
    out->order = owner->order.data();
    out->start = owner->r.outerIndexPtr();
    out->column = owner->r.innerIndexPtr();
    out->value = owner->r.valuePtr();
    out->entries = out->start[out->rank];
    out->extract = seconds_since(from);
    return QLESS_DONE;
}

}  // namespace

extern "C" {

// A is m x n by compressed columns (rows ascend, none is empty), B is m x k by columns and becomes Q^T B.
// A threshold below 0 stands for Eigen's own.
int qless_eigen_factor(int m, int n, const int *start, const int *row, const double *value, int k, double *rhs,
                       double threshold, qless_eigen *out) {
    *out = qless_eigen{};
    try {
        return factor(m, n, start, row, value, k, rhs, threshold, out);
    } catch (const std::bad_alloc &) {
        return QLESS_NO_MEMORY;
    } catch (const std::exception &error) {
        std::snprintf(out->message, sizeof out->message, "%s", error.what());
        return QLESS_FAILED;
    } catch (...) {
        return QLESS_FAILED;
    }
}

// Frees what a factorization holds, failed ones too.
void qless_eigen_free(qless_eigen *out) {
    delete static_cast<Owner *>(out->owner);
    out->owner = nullptr;
}

// major * 10000 + minor * 100 + patch.
int qless_eigen_version(void) {
    return EIGEN_WORLD_VERSION * 10000 + EIGEN_MAJOR_VERSION * 100 + EIGEN_MINOR_VERSION;
}

}  // extern "C"
