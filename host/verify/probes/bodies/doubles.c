static void probe(Probe* p) {
    cl_device_fp_config can = 0;
    clGetDeviceInfo(p->device, CL_DEVICE_DOUBLE_FP_CONFIG, sizeof can, &can, NULL);
    if (!can) p->lacks = "float64";
    else build(p, ""), prepare(p), launch(p, 16384, 64);
}
