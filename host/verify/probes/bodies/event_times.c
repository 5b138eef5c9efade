static void probe(Probe* p) {
    const size_t items = 16384, group = 64;
    cl_ulong times[4], before = 0;
    build(p, ""), prepare(p);
    for (int i = 0; i < 8; ++i) {
        cl_event event;
        clEnqueueNDRangeKernel(p->queue, p->kernel, 1, NULL, &items, &group, 0, NULL, &event);
        must(p, clWaitForEvents(1, &event), "clWaitForEvents");
        for (cl_uint k = 0; k < 4; ++k)  // queued, submitted, started, ended
            must(p, clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_QUEUED + k, 8, &times[k], NULL), "times");
        for (int k = 0; k < 3; ++k) expect(p, times[k] <= times[k + 1], "a time before the one that precedes it", k);
        expect(p, times[3] > times[2], "a command that takes no time", i);
        expect(p, times[2] >= before, "a command that starts before the one before it ended", i);
        before = times[3], clReleaseEvent(event);
    }
}
