static void probe(Probe* p) {
    cl_device_fp_config can = 0;
    clGetDeviceInfo(p->device, CL_DEVICE_SINGLE_FP_CONFIG, sizeof can, &can, NULL);
    if (!(can & CL_FP_DENORM)) p->lacks = "subnormal numbers, as it says; OpenCL allows that";
    build(p, ""), prepare(p), launch(p, 16384, 64);
}
