#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
typedef struct {
    cl_device_id device; cl_context context; cl_command_queue queue; cl_program program; cl_kernel kernel;
    cl_mem buffers[8]; cl_uint words[65536];            // what they get: a formula's values, then the results
    const char *source, *lacks;                         // the kernel, and what the device does not have
    size_t tried, wrong; char what[2000]; jmp_buf end;  // results, and the first wrong one
} Probe;
static void expect(Probe* p, int right, const char* what, long long number) {
    if (!right && p->wrong++ == 0) snprintf(p->what, sizeof p->what, "%.999s: %lld", what, number);
    p->tried++;
}
static void must(Probe* p, cl_int status, const char* call) {
    if (status != CL_SUCCESS) expect(p, 0, call, status), longjmp(p->end, 1);
}
static void try_probe(Probe* p, cl_device_id device, const char* source, void (*body)(Probe*)) {
    p->device = device, p->source = source;
    p->context = clCreateContext(NULL, 1, &device, NULL, NULL, NULL);
    p->queue = clCreateCommandQueue(p->context, device, CL_QUEUE_PROFILING_ENABLE, NULL);
    if (setjmp(p->end) == 0) body(p);
    for (int i = 0; i < 8; ++i) clReleaseMemObject(p->buffers[i]);
    clReleaseKernel(p->kernel), clReleaseProgram(p->program);
    clReleaseCommandQueue(p->queue), clReleaseContext(p->context);
}
