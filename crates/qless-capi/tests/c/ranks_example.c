/* A ring of ties over the DOFs of all ranks: the last equation repeats the others. Each rank owns two DOFs and gives two equations. */
#include <stdio.h>

#include "qless_mpi.h"

static void need(int status)
{
    if (status < 0) {
        fprintf(stderr, "%s\n", qless_message());
        MPI_Abort(MPI_COMM_WORLD, 1);
    }
}

int main(int argc, char **argv)
{
    MPI_Init(&argc, &argv);
    MPI_Comm communicator = MPI_COMM_WORLD;
    qless_ranks ranks;
    if (qless_mpi_ranks(&communicator, &ranks) != 0)
        MPI_Abort(communicator, 1);

    /* u_j - u_(j+1) = 0 for the two DOFs of this rank; u_0 = 3 is prescribed. */
    const int64_t first = 2 * ranks.rank, all = 2 * ranks.size, zero = 0;
    const int64_t numbers[] = {first, first + 1}, starts[] = {0, 2, 4}, columns[] = {first, first + 1, first + 1, (first + 2) % all};
    const double values[] = {1, -1, 1, -1}, value = 3;
    qless_distributed *analysis = NULL;
    need(qless_analyse_ranks(&ranks, 0, first, first + 2, 2, numbers, starts, columns, values, NULL, ranks.rank == 0, &zero, &value, 0,
                             NULL, NULL, &analysis));
    int64_t equations, dofs, rank, redundant, conflicting, local, masters;
    need(qless_distributed_counts(analysis, &equations, &dofs, &rank, &redundant, &conflicting));

    qless_elimination *elimination = NULL;
    need(qless_distributed_eliminate(&ranks, analysis, &elimination));
    need(qless_distributed_free(analysis));
    need(qless_distributed_dofs(elimination, NULL, 0, &local));
    need(qless_distributed_masters(elimination, NULL, 0, &masters));
    double u[3]; /* the DOFs of this rank, and u_0 in their rows of G */
    need(qless_expand(elimination, NULL, masters, u, local));
    if (ranks.rank == ranks.size - 1)
        printf("rank %d of %d equations; u = %g at the last DOF\n", (int)rank, (int)equations, u[local - 1]);
    need(qless_elimination_free(elimination));
    return MPI_Finalize();
}
