// The live view of a scene, served by a thread.
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>

#include <atomic>
#include <future>
#include <memory>

#include "claray/io.hpp"
#include "handles.hpp"
#include "host/view/web/web.hpp"

namespace claray::python {
namespace {

/// The thread has a queue of its own, and needs neither the GIL nor the lock of the device.
class ServedView {
public:
    ServedView(const PyDevice& device, const Scene& scene, const view::ViewConfig& config, view::WebConfig web) {
        auto url = std::make_shared<std::promise<std::string>>();
        web.goes_on = [ends = ends_] { return !*ends; };
        web.ready = [url](const std::string& address) { url->set_value(address); };
        std::future<std::string> ready = url->get_future();
        const Device own = without_gil(device, [&] { return device.device.with_new_queue(); });
        web.open = [own, config](const std::filesystem::path& file) {
            Warnings warnings;
            return view::View(own, load_scene(file.string(), warnings, {.live = true}), config);
        };
        served_ = std::async(std::launch::async, [=] { serve(own, scene, config, web, *url); });
        const nb::gil_scoped_release release;
        url_ = ready.get();
    }
    /// A process that fork() made has no such thread.
    ~ServedView() {
        if (is_forked()) {
            static_cast<void>(new std::future<void>(std::move(served_)));
            return;
        }
        const nb::gil_scoped_release release;
        *ends_ = true;
        if (served_.valid()) served_.wait();
    }
    ServedView(const ServedView&) = delete;
    ServedView& operator=(const ServedView&) = delete;

    [[nodiscard]] const std::string& url() const { return url_; }
    [[nodiscard]] bool is_open() const {
        return served_.valid() && served_.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
    }
    /// Throws what ended the view before, once.
    void close() {
        refuse_if_forked();
        const nb::gil_scoped_release release;
        *ends_ = true;
        if (served_.valid()) served_.get();
    }

private:
    /// An error before the address is known is that of the constructor.
    static void serve(const Device& device, const Scene& scene, const view::ViewConfig& config,
                      const view::WebConfig& web, std::promise<std::string>& url) {
        bool is_ready = false;
        view::WebConfig told = web;
        told.ready = [&](const std::string& address) { is_ready = true, web.ready(address); };
        try {
            view::View view(device, scene, config);
            view::serve(view, told);
        } catch (...) {
            if (is_ready) throw;
            url.set_exception(std::current_exception());
        }
    }

    std::shared_ptr<std::atomic<bool>> ends_ = std::make_shared<std::atomic<bool>>(false);
    std::string url_;
    std::future<void> served_;  // waits for the thread when it is destroyed
};

std::unique_ptr<ServedView> serve(const PyDevice& device, const Scene& scene, unsigned spp, float exposure,
                                  const std::string& host, int port) {
    view::ViewConfig config;
    config.render.width = 640, config.render.height = 360, config.render.spp = spp;
    config.picture.exposure = exposure;
    return std::make_unique<ServedView>(device, scene, config,
                                        view::WebConfig{.host = host, .port = port, .framed = true, .goes_on = {}});
}

}  // namespace

void bind_view(nb::module_& module) {
    nb::class_<ServedView>(module, "NativeView")
        .def_static("serve", &serve)
        .def("url", &ServedView::url)
        .def("is_open", &ServedView::is_open)
        .def("close", &ServedView::close);
}

}  // namespace claray::python
