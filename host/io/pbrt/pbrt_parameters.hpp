// The parameters of a statement of pbrt: "float radius" [ 2 ].
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/io/pbrt/pbrt_tokens.hpp"

namespace claray {

struct PbrtParameter {
    std::string type, name;
    std::vector<double> numbers = {};
    std::vector<std::string> texts = {};  ///< also the words true and false
};

class PbrtParameters {
public:
    /// Reads those that follow. Throws as PbrtTokens does.
    [[nodiscard]] static PbrtParameters read(PbrtTokens& tokens);

    [[nodiscard]] const PbrtParameter* find(std::string_view name) const;
    [[nodiscard]] double number(std::string_view name, double otherwise) const;
    [[nodiscard]] bool flag(std::string_view name, bool otherwise) const;
    [[nodiscard]] std::string text(std::string_view name, const std::string& otherwise = {}) const;
    [[nodiscard]] glm::dvec3 point(std::string_view name, const glm::dvec3& otherwise) const;
    [[nodiscard]] const std::vector<double>& numbers(std::string_view name) const;  ///< empty: there are none
    [[nodiscard]] std::vector<glm::vec3> vectors(std::string_view name) const;
    [[nodiscard]] std::vector<glm::vec2> pairs(std::string_view name) const;

    /// Values for what `this` does not state.
    void add_defaults(const PbrtParameters& defaults);
    [[nodiscard]] const std::string& place() const { return place_; }

private:
    std::vector<PbrtParameter> all_;
    std::string place_;  ///< file and line
};

}  // namespace claray
