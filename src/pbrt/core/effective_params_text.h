#pragma once
#include <nlohmann/json.hpp>

#include "pbrt/core/describe.h"

namespace pbrt {

/// Visitor that writes the values as JSON.
class ParamPrinter {
  public:
    using Json = nlohmann::basic_json<nlohmann::ordered_map, std::vector, std::string, bool, int64_t, uint64_t, Float>;
    Json json = Json::object();
    bool When(bool applies) const { return applies; }
    void OnlyWith(const char *, const char *) const {}
    template <class T, class... ConstraintAndHelp>
    void operator()(const std::string &name, T &value, const ConstraintAndHelp &...arguments) {
        if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
            json[name] = value;
        } else {  // same text as for a documented default
            ParamDocumenter documenter;
            documenter(name, value, arguments...);
            json[name] = documenter.docs.front().defaultValue;
        }
    }
};

/// Effective values as a JSON object with a member per parameter, for metadata and statistics. Numbers are printed in
/// their shortest single-precision form: 0.01, not 0.009999999776482582.
template <class P>
std::string EffectiveParamsText(P params) {
    ParamPrinter printer;
    params.Describe(printer);
    return printer.json.dump();
}

}  // namespace pbrt
