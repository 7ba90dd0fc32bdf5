#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "support.h"

namespace pbrt::test {
namespace {

/// The errors that the parser itself can find, with their columns; the other errors of the folder are found when the
/// entities are built.
const std::map<std::string, std::vector<Expected>> kFound = {
    {"bool_as_string", {{Severity::Error, 10, 42, "true or false"}}},
    {"camera_after_worldbegin", {{Severity::Error, 10, 0, "not allowed after WorldBegin"}}},
    {"directive_wrong_case", {{Severity::Error, 10, 0, "AttributeBegin"}, {Severity::Warning, 11, 0, ""}}},
    {"empty_file", {{Severity::Error, 0, 0, "ends before WorldBegin"}}},
    {"huge_integer", {{Severity::Error, 10, 38, "32-bit"}}},
    {"latin1_name", {{Severity::Error, 9, 18, "UTF-8"}}},
    {"missing_attribute_end", {{Severity::Error, 10, 0, "without AttributeEnd"}}},
    {"missing_closing_bracket", {{Severity::Error, 11, 0, "] missing"}}},
    {"missing_include_file", {{Severity::Error, 10, 8, "No such file"}}},
    {"missing_worldbegin", {{Severity::Error, 0, 0, "ends before WorldBegin"}}},
    {"nan_literal", {{Severity::Error, 10, 32, "Expected numbers"}}},
    {"non_utf8_name", {{Severity::Error, 9, 18, "UTF-8"}}},
    {"shape_before_worldbegin", {{Severity::Error, 8, 0, "not allowed before WorldBegin"}}},
    {"string_where_number_expected", {{Severity::Error, 10, 12, "Expected a number"}}},
    {"texture_redefined", {{Severity::Error, 11, 8, "defined twice"}}},
    {"transformbegin_deprecated", {{Severity::Warning, 10, 0, "deprecated"}}},
    {"truncated_parameter_list", {{Severity::Error, 10, 15, "Premature end of file"}}},
    {"unbalanced_attribute_end", {{Severity::Warning, 10, 0, "ignored"}}},
    {"undefined_named_material", {{Severity::Error, 11, 0, "not defined"}}},
    {"undefined_object_instance", {{Severity::Error, 10, 15, "not defined"}}},
    {"unknown_colorspace", {{Severity::Warning, 10, 11, "'srgb' stays in force"}}},
    {"unknown_coordinate_system", {{Severity::Warning, 10, 18, "stays as it is"}}},
    {"unknown_directive", {{Severity::Error, 10, 0, "Unknown directive: Sphere"}}},
    {"unknown_parameter_type", {{Severity::Error, 10, 19, "unknown parameter type"}}},
    {"unterminated_string", {{Severity::Error, 10, 9, "Unterminated"}}},
    {"utf16_byte_order_mark", {{Severity::Error, 1, 0, "UTF-16"}}},
};

TEST(Conformance, ErrorsArePointedAtWhereStockDoes) {
    const std::string suite = std::string(PBRT_SOURCE_DIR) + "/tests/conformance/suite/";
    size_t checked = 0;
    for (const auto &record : nlohmann::json::parse(std::ifstream(suite + "manifest.json"))) {
        if (record["category"] != "errors") continue;
        const std::string name = record["name"];
        Parsed parsed;
        ParseSceneFiles({suite + std::string(record["scene"])}, parsed.sink);
        auto found = kFound.find(name);
        if (found == kFound.end()) {
            EXPECT_TRUE(parsed.sink.All().empty()) << name << "\n" << Messages(parsed.sink);
            continue;
        }
        ++checked;
        ExpectMessages(parsed.sink, found->second, name);
        const auto &expected = record["expected"];
        EXPECT_EQ(parsed.sink.HasErrors(), expected["exit"] != "zero") << name;
        EXPECT_TRUE(expected["line"].is_null() || expected["line"] == found->second.front().line) << name;
    }
    EXPECT_EQ(checked, kFound.size());
}

}  // namespace
}  // namespace pbrt::test
