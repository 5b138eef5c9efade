// What ranks tell each other: the contents of messages. The functions that read bytes throw ErrorKind::user for bytes
// that no rank of this version sends.
#pragma once

#include "claray/renderer.hpp"
#include "host/ranks/session.hpp"
#include "host/scale/worker.hpp"
#include "host/scene/bytes.hpp"

namespace claray::ranks {

/// What must be equal on all ranks, and what each brings.
struct Hello {
    std::string version, options, host;
    std::vector<std::string> devices;  // their names
};
[[nodiscard]] std::string to_bytes(const Hello& hello);
[[nodiscard]] Hello hello_from(const std::string& bytes);

/// Why a rank ends.
struct Failure {
    int exit_code = 1;
    std::string text;
};
[[nodiscard]] std::string to_bytes(const Failure& failure);
[[nodiscard]] Failure failure_from(const std::string& bytes);
/// Without the lines of a log.
[[nodiscard]] Failure failure_of(ErrorKind kind, const std::string& text);

/// `number` counts the tasks; messages about earlier ones are ignored. Of a frame it is that of the animation.
struct RenderTask {
    std::uint32_t number = 0;
    RenderConfig config;
    Scene scene;
};
[[nodiscard]] std::string to_bytes(std::uint32_t number, const RenderConfig& config, const Scene& scene);
/// The compiler and the files of the configuration are left empty: they belong to a machine.
[[nodiscard]] RenderTask task_from(const std::string& bytes);

/// What a rank made of a frame of an animation.
struct RenderedFrame {
    std::uint32_t frame = 0;
    std::vector<std::string> names, files;  // of the files that rank 0 is to write, and what is in them
    std::vector<glm::vec3> pixels;          // of a video
    Failure failure;                        // without text if there is none
};
[[nodiscard]] std::string to_bytes(const RenderedFrame& frame);
[[nodiscard]] RenderedFrame rendered_from(const std::string& bytes);

struct RemoteOrder {
    std::uint32_t task = 0, device = 0;  // `device`: of the rank
    Order order;
    std::vector<FilmPixel> sums;
};
[[nodiscard]] std::string to_bytes(const RemoteOrder& order);
[[nodiscard]] RemoteOrder order_from(const std::string& bytes);

/// `report.worker` is the number of the rank's device.
struct RemoteReport {
    std::uint32_t task = 0;
    Report report;
};
[[nodiscard]] std::string to_bytes(const RemoteReport& report);
[[nodiscard]] RemoteReport report_from(const std::string& bytes);

}  // namespace claray::ranks
