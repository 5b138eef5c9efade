int main(int argc, char** argv) {  // with the number of a device
    static Probe p; static char source[8000], name[200], driver[200];
    cl_platform_id platforms[32]; cl_device_id devices[99];
    cl_uint count = 0, found = 0, more = 0, chosen = argc > 1 ? (cl_uint)atoi(argv[1]) : 0;
    clGetPlatformIDs(32, platforms, &count);
    for (cl_uint i = 0; i < count; ++i, found += more)
        if (clGetDeviceIDs(platforms[i], CL_DEVICE_TYPE_ALL, 99 - found, devices + found, &more)) more = 0;
    FILE* file = fopen(PROBE ".cl", "rb");
    if (chosen >= found || !file || !fread(source, 1, 7999, file)) return puts("no such device, or no " PROBE ".cl"), 2;
    try_probe(&p, devices[chosen], source, probe);
    clGetDeviceInfo(p.device, CL_DEVICE_NAME, 200, name, NULL);
    clGetDeviceInfo(p.device, CL_DRIVER_VERSION, 200, driver, NULL);
    printf("%s, driver %s: %zu of %zu are wrong. %s\n", name, driver, p.wrong, p.tried, p.what);
    return p.wrong > 0;
}
