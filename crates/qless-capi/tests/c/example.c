/* Three ties of three DOFs, one of which repeats the others, and a prescribed DOF. */
#include <stdio.h>
#include <stdlib.h>

#include "qless.h"

static void need(int status)
{
    if (status < 0) {
        fprintf(stderr, "%s\n", qless_message());
        exit(1);
    }
}

int main(void)
{
    /* u0 - u1 = 0.5, u1 - u2 = 0, u0 - u2 = 0.5; u2 = 1 is prescribed. */
    const int32_t starts[] = {0, 2, 4, 6}, columns[] = {0, 1, 1, 2, 0, 2}, dof = 2;
    const double values[] = {1, -1, 1, -1, 1, -1}, rhs[] = {0.5, 0, 0.5}, value = 1;
    qless_analysis *analysis = NULL;
    need(qless_analyse(3, 3, 0, starts, columns, values, rhs, 1, &dof, &value, NULL, &analysis));

    int64_t equations, dofs, rank, redundant, conflicting, count;
    need(qless_counts(analysis, &equations, &dofs, &rank, &redundant, &conflicting));
    int32_t rows[3];
    double coefficients[3];
    need(qless_explanation(analysis, 2, rows, coefficients, 3, &count));
    printf("rank %d of %d equations; row 2 =", (int)rank, (int)equations);
    for (int k = 0; k < count; k++)
        printf(" %+g * row %d", coefficients[k], (int)rows[k]);
    printf("\n");

    qless_elimination *elimination = NULL;
    need(qless_eliminate(analysis, &elimination));
    need(qless_analysis_free(analysis));
    double u[3];
    need(qless_expand(elimination, NULL, 0, u, 3)); /* there is no master */
    printf("u = %g %g %g\n", u[0], u[1], u[2]);
    need(qless_elimination_free(elimination));
    return 0;
}
