// The extension module claray._native: claray's handles for the package in python/claray, which checks arguments.
#include "handles.hpp"

NB_MODULE(_native, module) {
    using namespace claray::python;
    nb::set_leak_warnings(false);  // threads, and processes made by fork(), may end while they hold objects
    module.attr("version") = CLARAY_VERSION;
    bind_errors(module);
    bind_device(module);
    bind_bvh(module);
    bind_primitives(module);
    bind_instances(module);
    bind_lists(module);
    bind_points(module);
    bind_query(module);
    bind_textures(module);
    bind_records(module);
    bind_scene(module);
    bind_render_config(module);
    bind_sensors(module);
    bind_renderer(module);
    bind_bake(module);
    bind_explain(module);
    bind_accuracy(module);
    bind_verify(module);
    bind_view(module);
}
