#include <string.h>
static void probe(Probe* p) {
    cl_command_queue queues[4];
    cl_event events[65] = {NULL};
    const size_t items = 16384, group = 64;
    build(p, ""), prepare(p), memset(p->words, 0, sizeof p->words), argument(p, 2);
    for (int i = 0; i < 4; ++i) queues[i] = clCreateCommandQueue(p->context, p->device, 0, NULL);
    for (int i = 0; i < 64; ++i) {
        cl_event* before = i > 0 ? &events[i] : NULL;
        clEnqueueNDRangeKernel(queues[i % 4], p->kernel, 1, NULL, &items, &group, i > 0, before, &events[i + 1]);
        must(p, clFlush(queues[i % 4]), "clFlush");
    }
    for (int i = 0; i < 4; ++i) clFinish(queues[i]), clReleaseCommandQueue(queues[i]);
    for (int i = 1; i < 65; ++i) clReleaseEvent(events[i]);
    launch(p, items, group);
}
