static void probe(Probe* p) {
    cl_command_queue queues[4];
    cl_event events[65] = {NULL};
    const size_t items = 16384, group = 64;
    cl_uint step = 0;
    build(p, ""), prepare(p);
    for (int i = 0; i < 4; ++i) queues[i] = clCreateCommandQueue(p->context, p->device, 0, NULL);
    for (; step < 64; ++step) {
        cl_event* before = step > 0 ? &events[step] : NULL;
        clSetKernelArg(p->kernel, 2, 4, &step);
        clEnqueueNDRangeKernel(queues[step % 4], p->kernel, 1, 0, &items, &group, step > 0, before, &events[step + 1]);
        must(p, clFlush(queues[step % 4]), "clFlush");
    }
    for (int i = 0; i < 4; ++i) clFinish(queues[i]), clReleaseCommandQueue(queues[i]);
    for (int i = 1; i < 65; ++i) clReleaseEvent(events[i]);
    clSetKernelArg(p->kernel, 2, 4, &step), launch(p, items, group);
}
