/* A periodic plate of springs on the ranks of PETSc: L holds T and the identity, K_q = L^T K L is computed by MatPtAP, u = L u_q + u_0.
 * Every rank diagnoses all equations, with the same bits, and owns some rows of K and L. The model is that of eigen.cpp. */
#include <petscksp.h>

#include "qless.h"

enum { N = 8, DOFS = 2 * N * N, TIES = 4 * N };

_Static_assert(sizeof(PetscInt) == sizeof(int32_t), "for 64-bit indices of PETSc call the functions that end in _64");

/* Opposite sides move alike, up to a stretch; corners are tied twice, so that two equations are redundant. */
static qless_elimination *tied(void)
{
    int32_t starts[TIES + 1] = {0}, columns[2 * TIES], held[] = {0, 1};
    double values[2 * TIES], b[TIES], given[] = {0.1, -0.2};
    for (int i = 0; i < TIES; i++) {
        int side = i / (2 * N), a = i / 2 % N, d = i % 2;
        columns[2 * i] = 2 * (side == 0 ? N - 1 + N * a : a + N * (N - 1)) + d;
        columns[2 * i + 1] = 2 * (side == 0 ? N * a : a) + d;
        values[2 * i] = 1, values[2 * i + 1] = -1;
        b[i] = side == d ? 0.01 : 0;
        starts[i + 1] = 2 * (i + 1);
    }
    qless_analysis *analysis = NULL;
    qless_elimination *elimination = NULL;
    if (qless_analyse(TIES, DOFS, 0, starts, columns, values, b, 2, held, given, NULL, &analysis) < 0 ||
        qless_eliminate(analysis, &elimination) < 0)
        SETERRABORT(PETSC_COMM_WORLD, PETSC_ERR_LIB, qless_message());
    qless_analysis_free(analysis);
    return elimination;
}

static PetscErrorCode add_spring(Mat k, PetscInt a, PetscInt b, int along, PetscInt first, PetscInt last)
{
    for (int d = 0; d < 2; d++) {
        PetscScalar s = d == along ? 3 + 0.1 * (a % 7) : 1;
        PetscInt ends[] = {2 * a + d, 2 * b + d};
        for (int e = 0; e < 2; e++)
            if (ends[e] >= first && ends[e] < last) {
                PetscScalar row[] = {e == 0 ? s : -s, e == 0 ? -s : s};
                PetscCall(MatSetValues(k, 1, ends + e, 2, ends, row, ADD_VALUES));
            }
    }
    return 0;
}

static PetscErrorCode stiffness(Mat *k)
{
    PetscInt first, last;
    PetscCall(MatCreateAIJ(PETSC_COMM_WORLD, PETSC_DECIDE, PETSC_DECIDE, DOFS, DOFS, 5, NULL, 5, NULL, k));
    PetscCall(MatGetOwnershipRange(*k, &first, &last));
    for (int j = 0; j < N; j++)
        for (int i = 0; i < N; i++) {
            if (i + 1 < N)
                PetscCall(add_spring(*k, i + N * j, i + 1 + N * j, 0, first, last));
            if (j + 1 < N)
                PetscCall(add_spring(*k, i + N * j, i + N * (j + 1), 1, first, last));
        }
    PetscCall(MatAssemblyBegin(*k, MAT_FINAL_ASSEMBLY));
    PetscCall(MatAssemblyEnd(*k, MAT_FINAL_ASSEMBLY));
    return 0;
}

/* The rows of L that this rank owns: T for slaves, the identity for masters; and u_0. */
static PetscErrorCode elimination_matrix(const qless_elimination *elimination, Mat *l, Vec u_0)
{
    int64_t ns, nq, np, nt, ng;
    int32_t starts[DOFS + 1], columns[DOFS * 8], s[DOFS], q[DOFS];
    double t[DOFS * 8], zeros[DOFS] = {0}, all[DOFS];
    PetscInt first, last;
    qless_sizes(elimination, &ns, &nq, &np, &nt, &ng);
    PetscCheck(nt <= DOFS * 8, PETSC_COMM_WORLD, PETSC_ERR_ARG_OUTOFRANGE, "T has %d entries", (int)nt);
    qless_dofs(elimination, s, q, NULL);
    if (qless_t(elimination, starts, columns, t) < 0 || qless_expand(elimination, zeros, nq, all, DOFS) < 0)
        SETERRQ(PETSC_COMM_WORLD, PETSC_ERR_LIB, "%s", qless_message());
    PetscCall(MatCreateAIJ(PETSC_COMM_WORLD, PETSC_DECIDE, PETSC_DECIDE, DOFS, (PetscInt)nq, 8, NULL, 8, NULL, l));
    PetscCall(MatGetOwnershipRange(*l, &first, &last));
    for (PetscInt k = 0; k < nq; k++)
        if (q[k] >= first && q[k] < last)
            PetscCall(MatSetValue(*l, q[k], k, 1, INSERT_VALUES));
    for (int i = 0; i < ns; i++)
        if (s[i] >= first && s[i] < last)
            PetscCall(MatSetValues(*l, 1, s + i, starts[i + 1] - starts[i], columns + starts[i], t + starts[i], INSERT_VALUES));
    for (PetscInt j = first; j < last; j++)
        PetscCall(VecSetValue(u_0, j, all[j], INSERT_VALUES));
    PetscCall(MatAssemblyBegin(*l, MAT_FINAL_ASSEMBLY));
    PetscCall(MatAssemblyEnd(*l, MAT_FINAL_ASSEMBLY));
    PetscCall(VecAssemblyBegin(u_0));
    PetscCall(VecAssemblyEnd(u_0));
    return 0;
}

int main(int argc, char **argv)
{
    PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
    qless_elimination *elimination = tied();
    Mat k, l, k_q;
    Vec f, u, u_q, f_q, u_0;
    KSP ksp;
    PetscReal left, of_f, norm, largest;
    PetscInt unknowns, first, last;
    PetscCall(stiffness(&k));
    PetscCall(MatCreateVecs(k, &u, &f));
    PetscCall(VecDuplicate(u, &u_0));
    PetscCall(VecGetOwnershipRange(f, &first, &last));
    for (PetscInt j = first; j < last; j++)
        PetscCall(VecSetValue(f, j, j % 5 - 2.0, INSERT_VALUES));
    PetscCall(VecAssemblyBegin(f));
    PetscCall(VecAssemblyEnd(f));

    PetscCall(elimination_matrix(elimination, &l, u_0));
    PetscCall(MatPtAP(k, l, MAT_INITIAL_MATRIX, PETSC_DEFAULT, &k_q));
    PetscCall(MatCreateVecs(l, &u_q, NULL));
    PetscCall(VecDuplicate(u_q, &f_q));
    PetscCall(VecScale(u_0, -1));
    PetscCall(MatMultAdd(k, u_0, f, u));
    PetscCall(VecScale(u_0, -1));
    PetscCall(MatMultTranspose(l, u, f_q)); /* f_q = L^T (f - K u_0) */
    PetscCall(KSPCreate(PETSC_COMM_WORLD, &ksp));
    PetscCall(KSPSetType(ksp, KSPCG));
    PetscCall(KSPSetOperators(ksp, k_q, k_q));
    PetscCall(KSPSetTolerances(ksp, 1e-14, PETSC_DEFAULT, PETSC_DEFAULT, 1000));
    PetscCall(KSPSolve(ksp, f_q, u_q));
    PetscCall(MatMultAdd(l, u_q, u_0, u));

    /* In equilibrium the residual does no work on any motion that the equations allow: L^T (f - K u) = 0. */
    PetscCall(VecNorm(f_q, NORM_2, &of_f));
    PetscCall(VecScale(u, -1));
    PetscCall(MatMultAdd(k, u, f, f));
    PetscCall(MatMultTranspose(l, f, f_q));
    PetscCall(VecNorm(f_q, NORM_2, &left));
    PetscCheck(left < 1e-10 * of_f, PETSC_COMM_WORLD, PETSC_ERR_LIB, "the residual is %g", (double)(left / of_f));
    PetscCall(VecNorm(u, NORM_2, &norm));
    PetscCall(VecNorm(u, NORM_INFINITY, &largest));
    PetscCall(VecGetSize(u_q, &unknowns));
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%d masters, |u| = %.9f, largest %.9f\n", (int)unknowns, (double)norm, (double)largest));
    Vec vectors[] = {u, f, u_0, u_q, f_q};
    Mat matrices[] = {k, l, k_q};
    for (int i = 0; i < 5; i++)
        PetscCall(VecDestroy(vectors + i));
    for (int i = 0; i < 3; i++)
        PetscCall(MatDestroy(matrices + i));
    PetscCall(KSPDestroy(&ksp));
    qless_elimination_free(elimination);
    return PetscFinalize();
}
