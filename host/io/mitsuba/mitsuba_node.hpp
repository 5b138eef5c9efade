// The tree of a Mitsuba 3 scene: objects and properties, with defaults, includes and old names resolved.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace claray {

struct MitsubaNode {
    std::string tag;   ///< "bsdf", "float"
    std::string type;  ///< the plugin of an object
    std::string name, id;
    std::map<std::string, std::string> values = {};  ///< all other attributes
    std::vector<MitsubaNode> children = {};
    std::string place = {};  ///< "'scene.xml' line 12", for messages

    [[nodiscard]] const MitsubaNode* property(std::string_view name) const;
    [[nodiscard]] std::string value(std::string_view attribute) const;
    [[nodiscard]] double number(std::string_view name, double otherwise) const;
    [[nodiscard]] bool flag(std::string_view name, bool otherwise) const;
    [[nodiscard]] std::string text(std::string_view name, const std::string& otherwise = {}) const;
    [[nodiscard]] glm::dvec3 point(std::string_view name, const glm::dvec3& otherwise) const;
    /// A transform property; the identity if it is missing.
    [[nodiscard]] glm::dmat4 transform(std::string_view name) const;
    /// Throws ErrorKind::user with the place.
    [[noreturn]] void refuse(const std::string& what, const std::string& remedy) const;
};

/// The numbers of "1, 2 3". Throws ErrorKind::user at another word.
[[nodiscard]] std::vector<double> numbers_in(const std::string& text, const MitsubaNode& node);

/// Reads a file and those that it includes. Throws ErrorKind::user, naming the file and the line.
[[nodiscard]] MitsubaNode read_mitsuba(const std::filesystem::path& path);

}  // namespace claray
