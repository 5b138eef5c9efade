// claray.h: several devices.
#include "host/capi/renderer.hpp"
#include "host/capi/scene.hpp"

using namespace claray;
using namespace claray::capi;

claray_status claray_group_create(claray_device* const* devices, size_t count, const claray_scene* scene,
                                  const claray_render_config* config, claray_line_callback tell, void* user,
                                  claray_group** group) {
    return guarded([&] {
        std::vector<Device> all;
        for (const claray_device* device : array(devices, count, "devices"))
            all.push_back(required(device, "devices").device);
        if (all.empty()) refuse("count is 0", "give at least one device");
        const Scene& from = required(scene, "scene").scene;
        const RenderConfig known = render_config_of(config);
        std::function<void(const std::string&)> line;
        if (tell) line = [=](const std::string& text) { tell(text.c_str(), user); };
        hand_out(group, "group", [&] { return new claray_group(all, from, known, line); });
    });
}

claray_status claray_group_render(claray_group* group, claray_progress_callback callback, void* user,
                                  claray_progress* reached) {
    return guarded([&] {
        RenderGroup& used = required(group, "group").group;
        report([&](const auto& progress) { return used.render(progress); }, callback, user, reached);
    });
}

claray_status claray_group_renderer_create(claray_group* group, claray_renderer** renderer) {
    return guarded([&] {
        claray_group& of = required(group, "group");
        hand_out(renderer, "renderer", [&] {
            return new claray_renderer{of.config.width, of.config.height, of.group.renderer(), {}, {}, {}, {}};
        });
    });
}

claray_status claray_group_share_get(claray_group* group, size_t i, claray_device_share* share) {
    return guarded([&] {
        claray_group& of = required(group, "group");
        of.shares = of.group.shares();
        const DeviceShare& known = element(of.shares, i, "devices", "i");
        give(share,
             {sizeof(claray_device_share), known.name.c_str(), known.failure.c_str(), known.samples,
              known.samples_per_second},
             "share");
    });
}

const char* claray_group_checkpoint_error(const claray_group* group) {
    return group ? group->group.checkpoint_error().c_str() : "";
}
void claray_group_release(claray_group* group) { delete group; }
