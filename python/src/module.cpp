// The extension module claray._native: claray's handles for the package in python/claray, which checks arguments.
#include "handles.hpp"

NB_MODULE(_native, module) {
    using namespace claray::python;
    bind_errors(module);
    bind_device(module);
    bind_bvh(module);
    bind_primitives(module);
    bind_instances(module);
    bind_lists(module);
    bind_points(module);
    bind_query(module);
    bind_scene(module);
    bind_renderer(module);
    bind_accuracy(module);
    bind_verify(module);
}
