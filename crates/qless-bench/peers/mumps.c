// The rank of C as MUMPS finds it in the multiplier system [I C^T; C 0]: the equations less the pivots that it takes for null, with its own
// tolerance. Reads systems from standard input and writes `rank seconds` for each, or `failed` and why; super::solvers has the format.
#define _POSIX_C_SOURCE 199309L
#include <dmumps_c.h>
#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#ifdef __linux__
#include <signal.h>
#include <sys/prctl.h>
#endif

enum { END = -2, START = -1, ANALYSE_AND_FACTOR = 4 };
// INFOG(1) if the workspace for integers or for numbers was too small.
enum { FEW_INTEGERS = -8, FEW_NUMBERS = -9, MOST_TRIES = 8 };

typedef struct {
    uint64_t rows, cols, entries;
    int *row, *column;
    double *value;
} Multipliers;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void *read_array(size_t size, uint64_t count) {
    void *array = malloc(size * (count > 0 ? count : 1));
    if (array == NULL || fread(array, size, count, stdin) != count) {
        puts("failed it got no whole system, or no memory for it");
        exit(1);
    }
    return array;
}

// The lower triangle of [I C^T; C 0], numbered from 1; 0 at the end of the input.
static int read_system(Multipliers *out) {
    uint64_t size[3];
    if (fread(size, sizeof *size, 3, stdin) != 3) return 0;
    uint64_t rows = size[0], cols = size[1], entries = size[2];
    if (rows > INT_MAX || cols > INT_MAX - rows) {
        puts("failed more equations and DOFs than MUMPS counts");
        exit(1);
    }
    uint64_t *start = read_array(sizeof *start, cols + 1);
    uint32_t *row = read_array(sizeof *row, entries);
    double *value = read_array(sizeof *value, entries);
    *out = (Multipliers){rows, cols, cols + entries, malloc(sizeof(int) * (cols + entries + 1)),
                         malloc(sizeof(int) * (cols + entries + 1)), malloc(sizeof(double) * (cols + entries + 1))};
    if (out->row == NULL || out->column == NULL || out->value == NULL) exit(1);
    for (uint64_t j = 0; j < cols; j++) {
        out->row[j] = out->column[j] = (int)(j + 1);
        out->value[j] = 1;
    }
    for (uint64_t j = 0; j < cols; j++)
        for (uint64_t k = start[j]; k < start[j + 1]; k++) {
            out->row[cols + k] = (int)(cols + row[k] + 1);
            out->column[cols + k] = (int)(j + 1);
            out->value[cols + k] = value[k];
        }
    free(start), free(row), free(value);
    return 1;
}

// The number of null pivots, or the error of MUMPS, which is negative.
static int null_pivots(const Multipliers *system) {
    int error = 0, more = 50;
    for (int k = 0; k < MOST_TRIES; k++, more *= 4) {
        DMUMPS_STRUC_C id = {.job = START, .par = 1, .sym = 2, .comm_fortran = -987654};
        dmumps_c(&id);
        id.icntl[0] = id.icntl[1] = id.icntl[2] = -1;
        id.icntl[3] = 0;
        id.icntl[13] = more;
        id.icntl[23] = 1;
        id.n = (int)(system->rows + system->cols);
        id.nnz = (int64_t)system->entries;
        id.irn = system->row, id.jcn = system->column, id.a = system->value;
        id.job = ANALYSE_AND_FACTOR;
        dmumps_c(&id);
        error = id.infog[0];
        int found = id.infog[27];
        id.job = END;
        dmumps_c(&id);
        if (error >= 0) return found;
        if (error != FEW_INTEGERS && error != FEW_NUMBERS) break;
    }
    return error;
}

int main(void) {
#ifdef __linux__
    // Ends with the process that started it.
    prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
    Multipliers system;
    while (read_system(&system)) {
        double from = now();
        int found = null_pivots(&system);
        double seconds = now() - from;
        // The first run loads libraries; a short one is repeated.
        if (seconds < 0.25) from = now(), found = null_pivots(&system), seconds = now() - from;
        if (found < 0)
            printf("failed INFOG(1) = %d\n", found);
        else
            printf("%lld %.9f\n", (long long)system.rows - found, seconds);
        fflush(stdout);
        free(system.row), free(system.column), free(system.value);
    }
    return 0;
}
