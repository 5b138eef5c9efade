// The words of a pbrt file and of the files that it includes.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "claray/error.hpp"

namespace claray {

struct PbrtToken {
    enum class Kind { end, word, text, begin_list, end_list } kind = Kind::end;
    std::string value = {};  ///< of a text without its quotation marks
    std::size_t line = 0;
};

/// Reads one word after the other. All functions throw ErrorKind::user, naming the file and the line.
class PbrtTokens {
public:
    explicit PbrtTokens(const std::filesystem::path& path);

    [[nodiscard]] PbrtToken next();
    [[nodiscard]] const PbrtToken& peek();
    /// The next token, which must be a number, a text in quotation marks or a word.
    [[nodiscard]] double next_number();
    [[nodiscard]] std::string next_text();
    /// Goes on in another file, and returns to this one at its end. `name` is relative to the first file's folder.
    void include(const std::string& name);

    /// "'scene.pbrt' line 12: WHAT", at the token that was read last.
    [[noreturn]] void refuse(const std::string& what, const std::string& remedy) const;
    [[nodiscard]] std::string place() const;
    /// A number in a list or alone. Throws for anything else.
    [[nodiscard]] double number_of(const PbrtToken& token) const;

private:
    struct File {
        std::filesystem::path path;
        std::string text;
        std::size_t at = 0, line = 1;
    };
    void open(const std::filesystem::path& path);
    [[nodiscard]] PbrtToken read();
    [[nodiscard]] PbrtToken read_text(File& file);

    std::filesystem::path root_;
    std::vector<std::unique_ptr<File>> files_;
    std::size_t bytes_ = 0;
    PbrtToken ahead_;
    bool has_ahead_ = false;
    std::filesystem::path last_path_;
    std::size_t last_line_ = 1;
};

}  // namespace claray
