static void probe(Probe* p) {
    cl_device_fp_config can = 0;
    clGetDeviceInfo(p->device, CL_DEVICE_SINGLE_FP_CONFIG, sizeof can, &can, NULL);
    if (!(can & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT)) p->lacks = "correctly rounded division";
    else build(p, "-cl-fp32-correctly-rounded-divide-sqrt"), prepare(p), launch(p, 16384, 64);
}
