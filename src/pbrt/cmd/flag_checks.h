#pragma once

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <vector>

#include "pbrt/core/error.h"

namespace pbrt {

/// What to do instead of a flag that other programs have, by the flag in lower case without - and _.
using FlagHints = std::map<std::string, std::string>;

/// True for arguments that are written as flags: -x, --xyz, --xyz=value, but not numbers and not "-" or "--".
inline bool IsFlag(const std::string &argument) {
    const size_t name = argument.find_first_not_of('-');
    return (name == 1 || name == 2) && !std::isdigit(static_cast<unsigned char>(argument[name])) &&
           argument[name] != '.';
}

/// The option that an argument written as in CLI11's declarations names, or null.
inline const CLI::Option *FindOption(const CLI::App &app, const std::string &argument) {
    const std::string name = argument.substr(0, argument.find('='));
    for (const CLI::Option *option : app.get_options())
        if (IsFlag(name) && option->check_name(name)) return option;
    return nullptr;
}

/// Throws for a list of numbers that has another length than its option takes. CLI11 would count the words that follow,
/// whatever they are.
inline void CheckNumberList(const CLI::Option &option, const std::vector<std::string> &arguments, size_t at) {
    const int wanted = option.get_expected_min() * option.get_type_size_min();
    const size_t equals = arguments[at].find('=');
    std::string given;
    int count = 0;
    for (size_t i = at; i < arguments.size() && count < wanted; ++i) {
        if (i == at && equals == std::string::npos) continue;
        for (const std::string &word :
             CLI::detail::split(i == at ? arguments[i].substr(equals + 1) : arguments[i], ',')) {
            double number = 0;
            if (!CLI::detail::lexical_cast(word, number))
                throw CLI::ValidationError(fmt::format("{} takes {} numbers, {}: \"{}\" is not a number",
                                                       option.get_name(), wanted, option.get_type_name(), word));
            given += (count++ ? " " : "") + word;
        }
    }
    if (count != wanted)
        throw CLI::ValidationError(fmt::format("{} takes {} numbers, {}, but has {}{}{}", option.get_name(), wanted,
                                               option.get_type_name(), count, count ? ": " : "", given));
}

/// Throws CLI::ValidationError for the first flag that `app` lacks, with the nearest one that it has, and for lists of
/// numbers of the wrong length. To be called before CLI11 parses: it would report the first word that is left over,
/// which may be the value of a misspelt flag, or a file.
inline void CheckFlags(const CLI::App &app, const std::vector<std::string> &arguments, const FlagHints &hints = {}) {
    for (size_t i = 0; i < arguments.size() && arguments[i] != "--"; ++i) {
        if (!IsFlag(arguments[i])) continue;
        if (const CLI::Option *option = FindOption(app, arguments[i])) {
            if (option->get_expected_min() > 1) CheckNumberList(*option, arguments, i);
            if (option->get_expected_max() == 1 && option->get_type_size() == 1 &&
                arguments[i].find('=') == std::string::npos)
                ++i;  // its value
            continue;
        }
        const std::string flag = arguments[i].substr(0, arguments[i].find('='));
        const std::string name = CLI::detail::to_lower(flag.substr(flag.find_first_not_of('-')));
        std::string folded = name;
        std::erase_if(folded, [](char c) { return c == '-' || c == '_'; });
        if (const auto hint = hints.find(folded); hint != hints.end())
            throw CLI::ValidationError(fmt::format("{}: {}", flag, hint->second));
        std::vector<std::string> names;
        for (const CLI::Option *option : app.get_options())
            for (const std::string &known : option->get_lnames()) names.push_back(known);
        const std::string nearest = NearestChoice(name, names);
        throw CLI::ValidationError(fmt::format("unknown flag {}{}", flag,
                                               nearest.empty() ? "" : fmt::format("; did you mean --{}?", nearest)));
    }
}

}  // namespace pbrt
