/* Run a function over all states and return the processor time it took, ns per state.
 *
 * Compiled apart from what it calls, so that nothing is inlined, hoisted or left out.
 */
#define _POSIX_C_SOURCE 199309L
#include <time.h>

typedef void evaluate(const double *q, const double *qd, double *momentum, double *beta);
typedef void evaluate_core(const double *q, const double *qd, const double *temperature,
                           double *momentum, double *beta, double *friction);

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

double run(evaluate *function, int dof, int count, const double *q, const double *qd,
           double *momentum, double *beta)
{
    const double start = now();
    for (int i = 0; i < count; ++i) {
        const int k = dof * i;
        function(q + k, qd + k, momentum + k, beta + k);
    }
    return (now() - start) / count;
}

double run_core(evaluate_core *function, int dof, int count, const double *q, const double *qd,
                double *momentum, double *beta)
{
    const double temperature[6] = {30.0, 30.0, 30.0, 30.0, 30.0, 30.0};
    double friction[6];
    const double start = now();
    for (int i = 0; i < count; ++i) {
        const int k = dof * i;
        function(q + k, qd + k, temperature, momentum + k, beta + k, friction);
    }
    return (now() - start) / count;
}
