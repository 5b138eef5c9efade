#include "pack_rays.hpp"

#include <algorithm>
#include <atomic>
#include <bit>

#include "host/base/in_parallel.hpp"

namespace claray::python {
namespace {

constexpr std::size_t piece_size = std::size_t(1) << 15;  // rays, so that small queries start no threads

/// A row's number as float32.
template <class T>
float at(const Columns& columns, std::size_t row, unsigned column) {
    const char* bytes = static_cast<const char*>(columns.data);
    return float(
        *reinterpret_cast<const T*>(bytes + std::ptrdiff_t(row) * columns.row_stride + column * columns.column_stride));
}

/// 0, or NaN if x is infinite or NaN.
float nothing(float x) { return x - x; }

bool is_finite(const Ray& r) {
    return nothing(r.ox) + nothing(r.oy) + nothing(r.oz) + nothing(r.dx) + nothing(r.dy) + nothing(r.dz) == 0;
}

template <class Origins, class Directions, class Ends>
bool pack_piece(std::span<Ray> rays, const RayColumns& c, std::size_t first) {
    bool finite = true;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const std::size_t row = first + i;
        const Ray ray{at<Origins>(c.origins, row, 0),       at<Origins>(c.origins, row, 1),
                      at<Origins>(c.origins, row, 2),       at<Ends>(c.tmin, row, 0),
                      at<Directions>(c.directions, row, 0), at<Directions>(c.directions, row, 1),
                      at<Directions>(c.directions, row, 2), at<Ends>(c.tmax, row, 0)};
        rays[i] = ray;
        finite &= is_finite(ray);
    }
    return finite;
}

/// The case of most callers: contiguous float32, and the same ends for all.
bool is_plain(const RayColumns& c) {
    const auto contiguous = [](const Columns& x) {
        return !x.doubles && x.row_stride == 3 * sizeof(float) && x.column_stride == sizeof(float);
    };
    return contiguous(c.origins) && contiguous(c.directions) && c.tmin.row_stride == 0 && c.tmax.row_stride == 0;
}

bool pack_plain(std::span<Ray> rays, const RayColumns& c, std::size_t first) {
    const float* o = static_cast<const float*>(c.origins.data) + 3 * first;
    const float* d = static_cast<const float*>(c.directions.data) + 3 * first;
    const float tmin = c.tmin.doubles ? at<double>(c.tmin, 0, 0) : at<float>(c.tmin, 0, 0);
    const float tmax = c.tmax.doubles ? at<double>(c.tmax, 0, 0) : at<float>(c.tmax, 0, 0);
    bool finite = true;
    for (Ray& ray : rays) {
        ray = {o[0], o[1], o[2], tmin, d[0], d[1], d[2], tmax};
        finite &= is_finite(ray);
        o += 3, d += 3;
    }
    return finite;
}

bool pack(std::span<Ray> rays, const RayColumns& c, std::size_t first) {
    if (is_plain(c)) return pack_plain(rays, c, first);
    const auto with_directions = [&]<class Origins>(Origins) {  // the package gives both ends the same type
        if (c.directions.doubles)
            return c.tmin.doubles ? pack_piece<Origins, double, double>(rays, c, first)
                                  : pack_piece<Origins, double, float>(rays, c, first);
        return c.tmin.doubles ? pack_piece<Origins, float, double>(rays, c, first)
                              : pack_piece<Origins, float, float>(rays, c, first);
    };
    return c.origins.doubles ? with_directions(double{}) : with_directions(float{});
}

/// The first of `rays`, of which one is not finite.
std::size_t find_not_finite(std::span<const Ray> rays) {
    return std::size_t(std::find_if(rays.begin(), rays.end(), [](const Ray& ray) { return !is_finite(ray); }) -
                       rays.begin());
}

/// Numbers whose exponent is all ones are infinite or NaN. In this form compilers make vector instructions of it.
bool are_finite(std::span<const Ray> rays) {
    constexpr std::uint32_t exponent = 0x7f800000u;
    const auto* words = reinterpret_cast<const float*>(rays.data());
    std::uint32_t bad[8] = {};
    for (std::size_t i = 0; i < rays.size(); ++i)
        for (unsigned k = 0; k < 8; ++k)
            bad[k] |= std::uint32_t((std::bit_cast<std::uint32_t>(words[8 * i + k]) & exponent) == exponent);
    return (bad[0] | bad[1] | bad[2] | bad[4] | bad[5] | bad[6]) == 0;  // but tmin and tmax
}

/// Calls check(begin, count) for all pieces; returns the first ray of those for which it is false.
template <class Check>
std::size_t in_pieces(std::size_t count, const Check& check) {
    std::atomic<std::size_t> first_bad{all_finite};
    in_parallel((count + piece_size - 1) / piece_size, [&](std::size_t piece) {
        const std::size_t begin = piece * piece_size;
        if (check(begin, std::min(piece_size, count - begin))) return;
        std::size_t known = first_bad;
        while (begin < known && !first_bad.compare_exchange_weak(known, begin)) {
        }
    });
    return first_bad;
}

}  // namespace

std::size_t pack_rays(std::span<Ray> rays, const RayColumns& columns, std::size_t first) {
    const std::size_t piece = in_pieces(rays.size(), [&](std::size_t begin, std::size_t count) {
        return pack(rays.subspan(begin, count), columns, first + begin);
    });
    return piece == all_finite ? all_finite : first + piece + find_not_finite(rays.subspan(piece));
}

std::size_t first_not_finite(std::span<const Ray> rays) {
    const std::size_t piece = in_pieces(
        rays.size(), [&](std::size_t begin, std::size_t count) { return are_finite(rays.subspan(begin, count)); });
    return piece == all_finite ? all_finite : piece + find_not_finite(rays.subspan(piece));
}

}  // namespace claray::python
