// Sensors: patterns of beams, worlds and scans.
#include "claray/sensors.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "arrays.hpp"
#include "names.hpp"
#include "structures.hpp"

namespace claray::python {
namespace {

using Transforms = Input<float, nb::shape<-1, 3, 4>>;
using Poses = Input<double, nb::shape<-1, 4, 4>>;  // rows of matrices
using Words = Input<std::uint32_t, nb::shape<-1>>;
using Numbers = Input<float, nb::shape<-1>>;
using Angles = Input<double, nb::shape<-1>>;
using Beams = Input<float, nb::shape<-1, 4>>;
using Bytes = Output<std::uint8_t, nb::shape<-1, sizeof(SensorReturn)>>;

inline constexpr Named<ReturnOrder> orders[] = {
    {ReturnOrder::strongest, "strongest"}, {ReturnOrder::first, "first"}, {ReturnOrder::last, "last"}};
inline constexpr Named<LensKind> lens_kinds[] = {{LensKind::pinhole, "pinhole"},
                                                 {LensKind::equidistant, "equidistant"}};

struct PyWorld {
    PyDevice device;
    Kept<SensorWorld> world;
};

using Returns = Kept<Buffer<SensorReturn>>;

struct PySensor {
    PyDevice device;
    Kept<Sensor> sensor;
    std::shared_ptr<Returns> last = {};  // is used again once no scan has it
};

/// The returns of a scan, on the device.
struct PyScan {
    PyDevice device;
    std::shared_ptr<Returns> returns;
    std::size_t size;
};

Tuple arrays_of(BeamPattern pattern) {
    const std::size_t count = pattern.beams.size();
    return nb::make_tuple(pattern.rows, pattern.columns, array_of<float>(std::move(pattern.beams), {count, 4}));
}

BeamPattern pattern_of(std::uint32_t rows, std::uint32_t columns, const Beams& beams) {
    const std::span<const SensorBeam> all = span_of<SensorBeam>(beams, 4);
    return {rows, columns, {all.begin(), all.end()}};
}

template <class Matrix, class Array>
std::vector<Matrix> matrices_of(const Array& rows, int columns_each) {
    std::vector<Matrix> matrices(rows.shape(0), Matrix(1));
    for (std::size_t i = 0; i < matrices.size(); ++i)
        for (int row = 0; row < columns_each; ++row)
            for (int column = 0; column < 4; ++column)
                matrices[i][column][row] = rows.data()[4 * columns_each * i + 4 * row + column];
    return matrices;
}

PyWorld build(const PyDevice& device, const Scene& scene, const Words& movers, const Numbers& reflectances,
              const std::string& builder) {
    const Builder by = config_of(builder).builder;
    return without_gil(device, [&] {
        return PyWorld{device, SensorWorld::build(device.device, scene, span_of<std::uint32_t>(movers),
                                                  span_of<float>(reflectances), by)};
    });
}

void move(PyWorld& self, const Transforms& begins, const Transforms& ends) {
    without_gil(self.device,
                [&] { self.world.move(matrices_of<glm::mat4>(begins, 3), matrices_of<glm::mat4>(ends, 3)); });
}

std::vector<SensorPose> poses_of(const Poses& begins, const Poses& ends) {
    const auto from = matrices_of<glm::dmat4>(begins, 4), to = matrices_of<glm::dmat4>(ends, 4);
    std::vector<SensorPose> poses;
    for (std::size_t i = 0; i < from.size(); ++i) poses.push_back(sensor_pose(from[i], to[i]));
    return poses;
}

PyScan scan(PySensor& self, const PyWorld& world, const Poses& begins, const Poses& ends, std::uint32_t number) {
    return without_gil(self.device, [&] {
        const std::vector<SensorPose> poses = poses_of(begins, ends);
        const std::size_t size = self.sensor.size(poses.size());
        if (self.last.use_count() != 1 || self.last->size() < size)
            self.last = std::make_shared<Returns>(Buffer<SensorReturn>(self.device.device, size));
        self.sensor.scan(world.world, poses, number, *self.last);
        return PyScan{self.device, self.last, size};
    });
}

PySensor make_sensor(const PyDevice& device, const SensorConfig& config) {
    return without_gil(device, [&] { return PySensor{device, Sensor(device.device, config)}; });
}

void read(const PyScan& self, const Bytes& out) {
    without_gil(self.device,
                [&] { self.returns->read(std::span(reinterpret_cast<SensorReturn*>(out.data()), self.size)); });
}

void bind_config(nb::module_& module) {
    nb::class_<SensorConfig> config(module, "NativeSensorConfig");
    config.def(nb::init<>())
        .def("set_pattern", [](SensorConfig& self, std::uint32_t rows, std::uint32_t columns,
                               const Beams& beams) { self.pattern = pattern_of(rows, columns, beams); })
        .def_rw("rays", &SensorConfig::rays)
        .def_rw("returns", &SensorConfig::returns)
        .def_prop_rw(
            "divergence",
            [](const SensorConfig& c) {
                return std::vector{c.divergence[0], c.divergence[1]};
            },
            [](SensorConfig& c, const std::vector<double>& angles) {
                c.divergence = {angles.at(0), angles.at(1)};
            })
        .def_rw("nearest", &SensorConfig::nearest)
        .def_rw("farthest", &SensorConfig::farthest)
        .def_rw("range_resolution", &SensorConfig::range_resolution)
        .def_rw("velocity_resolution", &SensorConfig::velocity_resolution)
        .def_rw("range_noise", &SensorConfig::range_noise)
        .def_rw("velocity_noise", &SensorConfig::velocity_noise)
        .def_rw("intensity_noise", &SensorConfig::intensity_noise)
        .def_rw("dropout", &SensorConfig::dropout)
        .def_rw("reference_range", &SensorConfig::reference_range)
        .def_rw("extinction", &SensorConfig::extinction)
        .def_rw("least_intensity", &SensorConfig::least_intensity)
        .def_rw("duration", &SensorConfig::duration)
        .def_rw("in_world", &SensorConfig::in_world)
        .def_rw("seed", &SensorConfig::seed);
    def_named(config, "order", &SensorConfig::order, orders);
}

void bind_patterns(nb::module_& module) {
    module.def("spinning_beams", [](const Angles& elevations, std::uint32_t columns, double begin, double turn) {
        return arrays_of(spinning_beams(span_of<double>(elevations), columns, begin, turn));
    });
    module.def("raster_beams", [](std::uint32_t rows, std::uint32_t columns, double horizontal, double vertical) {
        return arrays_of(raster_beams(rows, columns, horizontal, vertical));
    });
    module.def("rosette_beams", [](std::uint32_t beams, double fov, double first, double second, double phase) {
        return arrays_of(rosette_beams(beams, fov, first, second, phase));
    });
    module.def(
        "camera_beams", [](std::uint32_t width, std::uint32_t height, const std::string& kind,
                           const std::vector<double>& focal, const std::vector<double>& distortion, double shutter) {
            Lens lens{kind_of("lens", kind, lens_kinds), focal.at(0), focal.at(1), focal.at(2), focal.at(3)};
            std::copy_n(distortion.begin(), std::min<std::size_t>(5, distortion.size()), lens.distortion.begin());
            return arrays_of(camera_beams(width, height, lens, shutter));
        });
}

}  // namespace

void bind_sensors(nb::module_& module) {
    bind_patterns(module);
    bind_config(module);
    nb::class_<PyWorld>(module, "NativeSensorWorld")
        .def_static("build", &build)
        .def("move", &move)
        .def("movers", [](const PyWorld& self) { return self.world.movers(); })
        .def("triangle_count", [](const PyWorld& self) { return self.world.triangle_count(); });
    nb::class_<PyScan>(module, "NativeScan").def("read", &read);
    nb::class_<PySensor>(module, "NativeSensor").def_static("make", &make_sensor).def("scan", &scan);
}

}  // namespace claray::python
