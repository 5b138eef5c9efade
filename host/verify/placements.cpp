#include "host/verify/placements.hpp"

#include <glm/gtc/matrix_transform.hpp>

namespace claray::verify {

glm::mat4 random_rotation(Random& random) {
    glm::vec3 axis = random.in_cube(1.f);
    while (glm::length(axis) < 0.1f) axis = random.in_cube(1.f);
    return glm::rotate(glm::mat4(1.f), random.uniform(0.f, 6.2831853f), glm::normalize(axis));
}

std::vector<Instance> random_instances(std::size_t count, std::uint32_t bottoms, float half, float scale,
                                       std::uint64_t seed) {
    Random random(seed);
    const auto stretch = [&] {
        return glm::vec3(random.uniform(0.5f, 1.5f), random.uniform(0.5f, 1.5f), random.uniform(0.5f, 1.5f));
    };
    std::vector<Instance> instances;
    for (std::size_t i = 0; i < count; ++i) {
        glm::mat4 m = glm::translate(glm::mat4(1.f), random.in_cube(half));
        m = glm::scale(m, scale * stretch()) * random_rotation(random);
        m = glm::scale(m, stretch() * glm::vec3(i % 3 == 0 ? -1.f : 1.f, 1.f, 1.f));
        instances.push_back(make_instance(m, random.below(bottoms), 0xffffffffu, std::uint32_t(1000 + i)));
    }
    return instances;
}

std::vector<Instance> moved(std::span<const Instance> begins, float far, std::uint64_t seed) {
    Random random(seed);
    std::vector<Instance> ends(begins.begin(), begins.end());
    for (Instance& end : ends) {
        glm::mat4 m(1.f);
        for (int k = 0; k < 4; ++k) m[k] = glm::vec4(end.row0[k], end.row1[k], end.row2[k], k == 3);
        const glm::vec4 at = m[3] + glm::vec4(random.in_cube(far), 0.f);
        m[3] = glm::vec4(0, 0, 0, 1);
        glm::vec3 axis = random.in_cube(1.f) + glm::vec3(0.01f);
        m = glm::rotate(glm::mat4(1.f), random.uniform(0.f, 0.8f), glm::normalize(axis)) *
            glm::scale(glm::mat4(1.f), glm::vec3(random.uniform(0.7f, 1.4f))) * m;
        m[3] = at;
        end = make_instance(m, end.bottom, end.mask, end.id);
    }
    return ends;
}

std::vector<Instance> moved_in_part(std::span<const Instance> begins, float far, std::uint64_t seed) {
    std::vector<Instance> ends = moved(begins, far, seed);
    for (std::size_t i = 0; i < ends.size(); ++i) {
        Instance& end = ends[i];
        const Instance& begin = begins[i];
        for (unsigned k = 0; k < 4; ++k) {
            float* const to[] = {&end.row0[k], &end.row1[k], &end.row2[k]};
            const float from[] = {begin.row0[k], begin.row1[k], begin.row2[k]};
            for (unsigned row = 0; row < 3; ++row)
                if (row != i % 3) *to[row] = from[row];
        }
    }
    return ends;
}

}  // namespace claray::verify
