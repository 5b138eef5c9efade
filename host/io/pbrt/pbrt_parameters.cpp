#include "host/io/pbrt/pbrt_parameters.hpp"

#include "host/io/words.hpp"

namespace claray {
namespace {

using Token = PbrtToken::Kind;

void add_value(PbrtParameter& parameter, PbrtToken token, const PbrtTokens& tokens) {
    if (token.kind == Token::text || token.value == "true" || token.value == "false")
        parameter.texts.push_back(std::move(token.value));
    else
        parameter.numbers.push_back(tokens.number_of(token));
}

PbrtParameter read_parameter(PbrtTokens& tokens) {
    const std::string declaration = tokens.next_text();
    std::string_view rest = declaration;
    PbrtParameter parameter;
    parameter.type = next_word(rest), parameter.name = next_word(rest);
    if (parameter.name.empty())
        tokens.refuse("the parameter " + claray::quoted(declaration) + " has no type or no name",
                      "write \"float radius\"");
    PbrtToken value = tokens.next();
    if (value.kind != Token::begin_list) {
        if (value.kind == Token::end) tokens.refuse("the file ends in a parameter", "save the file again");
        add_value(parameter, std::move(value), tokens);
        return parameter;
    }
    for (value = tokens.next(); value.kind != Token::end_list; value = tokens.next()) {
        if (value.kind == Token::end || value.kind == Token::begin_list)
            tokens.refuse("a list does not end", "add the bracket");
        add_value(parameter, std::move(value), tokens);
    }
    return parameter;
}

}  // namespace

PbrtParameters PbrtParameters::read(PbrtTokens& tokens) {
    PbrtParameters parameters;
    parameters.place_ = tokens.place();
    while (tokens.peek().kind == Token::text) parameters.all_.push_back(read_parameter(tokens));
    return parameters;
}

const PbrtParameter* PbrtParameters::find(std::string_view name) const {
    for (const PbrtParameter& parameter : all_)
        if (parameter.name == name) return &parameter;
    return nullptr;
}

double PbrtParameters::number(std::string_view name, double otherwise) const {
    const PbrtParameter* found = find(name);
    return found && !found->numbers.empty() ? found->numbers[0] : otherwise;
}

bool PbrtParameters::flag(std::string_view name, bool otherwise) const {
    const PbrtParameter* found = find(name);
    return found && !found->texts.empty() ? found->texts[0] == "true" : otherwise;
}

std::string PbrtParameters::text(std::string_view name, const std::string& otherwise) const {
    const PbrtParameter* found = find(name);
    return found && !found->texts.empty() ? found->texts[0] : otherwise;
}

glm::dvec3 PbrtParameters::point(std::string_view name, const glm::dvec3& otherwise) const {
    const std::vector<double>& all = numbers(name);
    return all.size() >= 3 ? glm::dvec3(all[0], all[1], all[2]) : otherwise;
}

const std::vector<double>& PbrtParameters::numbers(std::string_view name) const {
    static const std::vector<double> none;
    const PbrtParameter* found = find(name);
    return found ? found->numbers : none;
}

std::vector<glm::vec3> PbrtParameters::vectors(std::string_view name) const {
    const std::vector<double>& all = numbers(name);
    std::vector<glm::vec3> result;
    for (std::size_t i = 0; i + 2 < all.size(); i += 3) result.emplace_back(all[i], all[i + 1], all[i + 2]);
    return result;
}

std::vector<glm::vec2> PbrtParameters::pairs(std::string_view name) const {
    const std::vector<double>& all = numbers(name);
    std::vector<glm::vec2> result;
    for (std::size_t i = 0; i + 1 < all.size(); i += 2) result.emplace_back(all[i], all[i + 1]);
    return result;
}

void PbrtParameters::add_defaults(const PbrtParameters& defaults) {
    for (const PbrtParameter& each : defaults.all_)
        if (!find(each.name)) all_.push_back(each);
}

}  // namespace claray
