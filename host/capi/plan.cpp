// claray.h: renders to an error, for a time, or at a rate of frames.
#include "claray/plan/target.hpp"

#include "host/capi/members.hpp"
#include "host/capi/renderer.hpp"
#include "host/capi/scene.hpp"

using namespace claray;
using namespace claray::capi;

struct claray_plan {
    Device device;
    TargetPlan plan;
    RenderProgress reached;
    ConfigTexts texts;
    std::string account;
};
struct claray_frames {
    FramesReport report;
    std::string approximate;
};

namespace {

MeasuringProgress measuring_of(claray_measuring_callback callback, void* user) {
    if (!callback) return {};
    return [=](const std::string& what) { return callback(what.c_str(), user) != 0; };
}

claray_device_model model_of(const DeviceModel& model) {
    claray_device_model known{};
#define CLARAY_ROW(name, NAME, note, codes, splits) \
    known.name = {model.name.build_nanoseconds, model.name.samples_per_second};
    CLARAY_PLANNED_BUILDERS(CLARAY_ROW)
#undef CLARAY_ROW
    known.independent_cost = model.independent_cost;
    known.known = model.known() ? 1 : 0;
    return known;
}

DeviceModel model_of(const claray_device_model* given) {
    const claray_device_model known = versioned(&required(given, "model"), "model");
    DeviceModel model;
#define CLARAY_ROW(name, NAME, note, codes, splits) \
    model.name = {known.name.build_nanoseconds, known.name.samples_per_second};
    CLARAY_PLANNED_BUILDERS(CLARAY_ROW)
#undef CLARAY_ROW
    model.independent_cost = known.independent_cost;
    return model;
}

}  // namespace

claray_status claray_device_model_get(const claray_device* device, claray_device_model* model) {
    return guarded([&] { give(model, model_of(stored_model(required(device, "device").device)), "model"); });
}

claray_status claray_device_model_measure(claray_device* device, size_t triangles, claray_measuring_callback callback,
                                          void* user, claray_device_model* model) {
    return guarded([&] {
        const Device& on = required(device, "device").device;
        static_cast<void>(struct_size(required(model, "model"), "model"));
        give(model, model_of(measure_model(on, triangles ? triangles : 100'000, measuring_of(callback, user))),
             "model");
    });
}

claray_status claray_device_model_rows_create(const claray_device_model* model, claray_lines** rows) {
    return guarded([&] {
        std::vector<std::string> lines;
        for (const ModelRow& row : rows_of(model_of(model)))
            lines.push_back(row.kernel + " " + row.parameter + " " + std::to_string(row.value));
        hand_out(rows, "rows", [&] { return new claray_lines{std::move(lines)}; });
    });
}

claray_status claray_device_model_builder(const claray_device_model* model, size_t triangles, double seconds,
                                          claray_builder built, claray_builder* builder) {
    return guarded([&] {
        put(required(builder, "builder"),
            choose_builder(model_of(model), triangles, seconds, enumerator(built, "built")));
    });
}

claray_status claray_builder_for_samples(const claray_device* device, const claray_scene* scene,
                                         const claray_render_config* config, claray_builder* builder) {
    return guarded([&] {
        const Device& on = required(device, "device").device;
        put(required(builder, "builder"),
            choose_builder_for_samples(on, required(scene, "scene").scene, render_config_of(config)));
    });
}

claray_status claray_plan_create(claray_device* device, const claray_scene* scene, const claray_render_config* config,
                                 int keep_builder, claray_measuring_callback callback, void* user, claray_plan** plan) {
    return guarded([&] {
        const Device& on = required(device, "device").device;
        const Scene& of = required(scene, "scene").scene;
        const RenderConfig wanted = render_config_of(config);
        hand_out(plan, "plan", [&] {
            return new claray_plan{
                on, plan_render(on, of, wanted, keep_builder == 0, measuring_of(callback, user)), {}, {}, {}};
        });
    });
}

claray_status claray_plan_config_get(claray_plan* plan, claray_render_config* config) {
    return guarded([&] {
        claray_plan& of = required(plan, "plan");
        of.texts = {};
        give(config, render_config_of(of.plan.config, of.texts), "config");
    });
}

claray_status claray_plan_render(claray_plan* plan, claray_renderer* renderer, claray_progress_callback callback,
                                 void* user, claray_progress* reached) {
    return guarded([&] {
        claray_plan& of = required(plan, "plan");
        Renderer& used = required(renderer, "renderer").renderer;
        report([&](const auto& progress) { return of.reached = render_to_target(of.device, used, of.plan, progress); },
               callback, user, reached);
    });
}

claray_status claray_plan_render_group(claray_plan* plan, claray_group* group, claray_progress_callback callback,
                                       void* user, claray_progress* reached) {
    return guarded([&] {
        claray_plan& of = required(plan, "plan");
        RenderGroup& used = required(group, "group").group;
        report([&](const auto& progress) { return of.reached = render_to_target(used, of.plan, progress); }, callback,
               user, reached);
    });
}

claray_status claray_plan_result_get(claray_plan* plan, claray_plan_result* result) {
    return guarded([&] {
        claray_plan& of = required(plan, "plan");
        of.account = account_of(of.plan, of.reached);
        give(result,
             {sizeof(claray_plan_result), of.plan.promised_seconds, is_kept(of.plan, of.reached) ? 1 : 0,
              of.account.c_str()},
             "result");
    });
}

claray_status claray_plan_picks_create(const claray_plan* plan, claray_lines** picks) {
    return guarded([&] {
        const TargetPlan& of = required(plan, "plan").plan;
        hand_out(picks, "picks", [&] { return new claray_lines{of.picks}; });
    });
}
void claray_plan_release(claray_plan* plan) { delete plan; }

claray_status claray_frames_create(claray_device* device, const claray_scene* scene, const claray_render_config* config,
                                   const claray_frames_config* wanted, claray_frame_callback callback, void* user,
                                   claray_frames** frames) {
    return guarded([&] {
        const Device& on = required(device, "device").device;
        const Scene& of = required(scene, "scene").scene;
        const claray_frames_config given = versioned(wanted, "wanted");
        FramesConfig known;
        if (given.fps != 0) known.fps = given.fps;
        if (given.frames != 0) known.frames = given.frames;
        known.orbit = given.orbit, known.picks_builder = given.keep_builder == 0;
        std::function<bool(unsigned)> progress;
        if (callback) progress = [=](unsigned done) { return callback(done, user) != 0; };
        hand_out(frames, "frames", [&] {
            FramesReport report =
                render_frames(on, of, render_config_of(config), known, progress, measuring_of(given.measuring, user));
            std::string approximate = to_string(report.approximate);
            return new claray_frames{std::move(report), std::move(approximate)};
        });
    });
}

claray_status claray_frames_get(const claray_frames* frames, claray_frames_report* report) {
    return guarded([&] {
        const claray_frames& of = required(frames, "frames");
        claray_frames_report known{};
        known.spp = of.report.spp, known.max_depth = of.report.max_depth;
        known.width = of.report.width, known.height = of.report.height;
        known.approximate = of.approximate.c_str();
        known.error = of.report.error, known.median = of.report.median, known.percentile = of.report.percentile;
        known.seconds = of.report.seconds.data(), known.frame_count = of.report.seconds.size();
        known.image = of.report.image.empty() ? nullptr : &of.report.image[0][0];
        known.image_count = 3 * of.report.image.size();
        give(report, known, "report");
    });
}

claray_status claray_frames_picks_create(const claray_frames* frames, claray_lines** picks) {
    return guarded([&] {
        const FramesReport& of = required(frames, "frames").report;
        hand_out(picks, "picks", [&] { return new claray_lines{of.picks}; });
    });
}
void claray_frames_release(claray_frames* frames) { delete frames; }
