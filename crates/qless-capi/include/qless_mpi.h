/* The ranks of an MPI communicator for qless_analyse_ranks. The compiler wrapper of your MPI compiles these functions with your program, so
 * that libqless serves every MPI. They use collective calls only, which do not mix with your messages, and need MPI_THREAD_FUNNELED.
 *
 *     MPI_Comm communicator = MPI_COMM_WORLD;
 *     qless_ranks ranks;
 *     int status = qless_mpi_ranks(&communicator, &ranks);       0, or an error; communicator must live as long as ranks
 *
 * Errors are those of MPI, or the negative numbers below. MPI ends the job at its own errors, unless the communicator returns them.
 */
#ifndef QLESS_MPI_H
#define QLESS_MPI_H

#include <limits.h>
#include <stdlib.h>

#include <mpi.h>

#include "qless.h"

#define QLESS_MPI_TOO_MANY -1   /* a rank sends or receives 2^31 words (16 GiB) at once, more than an int counts */
#define QLESS_MPI_MEMORY -2     /* there is no memory for the counts */
#define QLESS_MPI_TWO_GROUPS -3 /* an inter-communicator: merge its groups first (MPI_Intercomm_merge) */

/* Counts and places as MPI takes them. */
static inline int qless_mpi_places(int size, const int64_t *counts, int *as_int, int *places)
{
    int64_t place = 0;
    for (int rank = 0; rank < size; rank++) {
        if (counts[rank] > INT_MAX - place)
            return QLESS_MPI_TOO_MANY;
        as_int[rank] = (int)counts[rank];
        places[rank] = (int)place;
        place += counts[rank];
    }
    return 0;
}

static inline int qless_mpi_exchange(void *context, const uint64_t *sent, const int64_t *sent_counts, uint64_t *received,
                                     const int64_t *received_counts)
{
    MPI_Comm communicator = *(MPI_Comm *)context;
    int size, status = MPI_Comm_size(communicator, &size);
    if (status != MPI_SUCCESS)
        return status;
    int *of_sent = (int *)malloc(4 * sizeof(int) * (size_t)size), *of_received = of_sent + 2 * (size_t)size;
    if (of_sent == NULL)
        return QLESS_MPI_MEMORY;
    status = qless_mpi_places(size, sent_counts, of_sent, of_sent + size);
    if (status == 0)
        status = qless_mpi_places(size, received_counts, of_received, of_received + size);
    if (status == 0)
        status = MPI_Alltoallv(sent, of_sent, of_sent + size, MPI_UINT64_T, received, of_received, of_received + size, MPI_UINT64_T,
                               communicator);
    free(of_sent);
    return status;
}

static inline int qless_mpi_reduce(void *context, uint64_t *numbers, int64_t count, int is_max)
{
    if (count > INT_MAX)
        return QLESS_MPI_TOO_MANY;
    return MPI_Allreduce(MPI_IN_PLACE, numbers, (int)count, MPI_UINT64_T, is_max ? MPI_MAX : MPI_SUM, *(MPI_Comm *)context);
}

static inline int qless_mpi_gather(void *context, const uint64_t *numbers, int64_t count, uint64_t *all)
{
    if (count > INT_MAX)
        return QLESS_MPI_TOO_MANY;
    return MPI_Allgather(numbers, (int)count, MPI_UINT64_T, all, (int)count, MPI_UINT64_T, *(MPI_Comm *)context);
}

static inline int qless_mpi_ranks(MPI_Comm *communicator, qless_ranks *ranks)
{
    int rank, size, has_two_groups, status = MPI_Comm_test_inter(*communicator, &has_two_groups);
    if (status == MPI_SUCCESS && has_two_groups)
        return QLESS_MPI_TWO_GROUPS;
    if (status == MPI_SUCCESS)
        status = MPI_Comm_rank(*communicator, &rank);
    if (status == MPI_SUCCESS)
        status = MPI_Comm_size(*communicator, &size);
    if (status != MPI_SUCCESS)
        return status;
    ranks->context = communicator;
    ranks->rank = rank;
    ranks->size = size;
    ranks->exchange = qless_mpi_exchange;
    ranks->reduce = qless_mpi_reduce;
    ranks->gather = qless_mpi_gather;
    return 0;
}

#endif
