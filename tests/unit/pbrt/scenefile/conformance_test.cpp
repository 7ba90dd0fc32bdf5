#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "support.h"

namespace pbrt::test {
namespace {

const std::string kShared = std::string(PBRT_SOURCE_DIR) + "/../shared";

class Conformance : public ::testing::Test {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists(kShared + "/conformance/manifest.json"))
            GTEST_SKIP() << "NOT TESTED: " << kShared << "/conformance is absent";
    }
    static nlohmann::json Manifest() {
        return nlohmann::json::parse(std::ifstream(kShared + "/conformance/manifest.json"));
    }
    static Parsed ParseScene(const std::string &scene) {
        Parsed parsed;
        parsed.scene = ParseSceneFiles({kShared + "/conformance/" + scene}, parsed.sink);
        return parsed;
    }
};

/// The errors that the parser itself can find, with their columns; the other errors of the folder are found when the
/// entities are built.
const std::map<std::string, Expected> kFound = {
    {"bool_as_string", {Severity::Error, 10, 42, "true or false"}},
    {"camera_after_worldbegin", {Severity::Error, 10, 0, "not allowed after WorldBegin"}},
    {"empty_file", {Severity::Error, 0, 0, "ends before WorldBegin"}},
    {"huge_integer", {Severity::Error, 10, 38, "32-bit"}},
    {"latin1_name", {Severity::Error, 9, 18, "UTF-8"}},
    {"missing_attribute_end", {Severity::Error, 10, 0, "without AttributeEnd"}},
    {"missing_closing_bracket", {Severity::Error, 11, 0, "] missing"}},
    {"missing_include_file", {Severity::Error, 10, 8, "No such file"}},
    {"missing_worldbegin", {Severity::Error, 0, 0, "ends before WorldBegin"}},
    {"nan_literal", {Severity::Error, 10, 32, "Expected numbers"}},
    {"non_utf8_name", {Severity::Error, 9, 18, "UTF-8"}},
    {"shape_before_worldbegin", {Severity::Error, 8, 0, "not allowed before WorldBegin"}},
    {"string_where_number_expected", {Severity::Error, 10, 12, "Expected a number"}},
    {"texture_redefined", {Severity::Error, 11, 8, "defined twice"}},
    {"transformbegin_deprecated", {Severity::Warning, 10, 0, "deprecated"}},
    {"truncated_parameter_list", {Severity::Error, 10, 15, "Premature end of file"}},
    {"unbalanced_attribute_end", {Severity::Warning, 10, 0, "ignored"}},
    {"undefined_named_material", {Severity::Error, 11, 0, "not defined"}},
    {"undefined_object_instance", {Severity::Error, 10, 15, "not defined"}},
    {"unknown_colorspace", {Severity::Warning, 10, 11, "stays in force"}},
    {"unknown_coordinate_system", {Severity::Warning, 10, 18, "stays as it is"}},
    {"unknown_directive", {Severity::Error, 10, 0, "Unknown directive: Sphere"}},
    {"unknown_parameter_type", {Severity::Error, 10, 19, "unknown parameter type"}},
    {"unterminated_string", {Severity::Error, 10, 9, "Unterminated"}},
    {"utf16_byte_order_mark", {Severity::Error, 1, 0, "UTF-16"}},
};

TEST_F(Conformance, ErrorsArePointedAtWhereStockDoes) {
    size_t checked = 0;
    for (const auto &record : Manifest()) {
        if (record["category"] != "errors") continue;
        std::string name = record["name"];
        Parsed parsed = ParseScene(record["scene"]);
        if (name == "directive_wrong_case") {
            ExpectMessages(parsed.sink, {{Severity::Error, 10, 0, "AttributeBegin"}, {Severity::Warning, 11, 0, ""}},
                           name);
            continue;
        }
        auto found = kFound.find(name);
        if (found == kFound.end()) {
            EXPECT_TRUE(parsed.sink.All().empty()) << name << "\n" << Messages(parsed.sink);
            continue;
        }
        ++checked;
        ExpectMessages(parsed.sink, {found->second}, name);
        const auto &expected = record["expected"];
        bool stockFails = expected["exit"] != "zero";
        EXPECT_EQ(parsed.sink.HasErrors(), stockFails) << name;
        if (!expected["line"].is_null()) {
            EXPECT_EQ(found->second.line, expected["line"].get<int>()) << name;
        }
    }
    EXPECT_EQ(checked, kFound.size());
}

TEST_F(Conformance, EverySceneWithAPictureParsesWithoutErrors) {
    size_t scenes = 0;
    for (const auto &record : Manifest()) {
        if (record["category"] == "errors") continue;
        ++scenes;
        Parsed parsed = ParseScene(record["scene"]);
        EXPECT_FALSE(parsed.sink.HasErrors()) << record["name"] << "\n" << Messages(parsed.sink);
        const SceneDescription &scene = parsed.scene;
        EXPECT_FALSE(scene.shapes.empty() && scene.instances.empty() && scene.lights.empty()) << record["name"];
    }
    EXPECT_GT(scenes, 50u);
}

TEST_F(Conformance, LargeScenesParse) {
    for (const char *name :
         {"lamp/lamp.pbrt", "lamp/scene-v4.pbrt", "veach-ajar/veach-ajar.pbrt", "veach-ajar/scene-v4.pbrt"}) {
        DiagnosticSink sink;
        SceneDescription scene = ParseSceneFiles({kShared + "/scenes/" + name}, sink);
        EXPECT_EQ("", Messages(sink)) << name;
        EXPECT_GT(scene.shapes.size(), 5u) << name;
    }
}

/// The kind of a shape, and the world positions of the points that fix its place and size, in a canonical order.
struct Placement {
    std::string type, material;
    std::vector<Point3> points;
};

std::vector<Placement> Placements(const SceneDescription &scene) {
    std::vector<Placement> placements;
    auto add = [&](const ShapeEntity &s, const Transform &worldFromObject) {
        Placement p{s.type, "diffuse", {}};
        if (!s.material.name.empty()) {
            for (const MaterialEntity &m : scene.materials)
                if (m.name == s.material.name) p.material = m.type;
        } else if (s.material.index >= 0) {
            p.material = scene.materials[static_cast<size_t>(s.material.index)].type;
        }
        Transform t = worldFromObject * s.ctm.start;
        Float r = FloatOf(s.params, "radius", 1);
        const Param *points = s.params.Find("P", ParamType::Point3);
        const std::vector<Float> list = points ? points->floats : std::vector<Float>();
        for (size_t i = 0; i + 2 < list.size(); i += 3)
            p.points.push_back(t.Point({list[i], list[i + 1], list[i + 2]}));
        if (list.empty())
            for (Point3 q :
                 {Point3(0, 0, 0), Point3(r, 0, 0), Point3(0, r, 0), Point3(0, 0, FloatOf(s.params, "zmin", -r))})
                p.points.push_back(t.Point(q));
        placements.push_back(p);
    };
    for (const ShapeEntity &s : scene.shapes) add(s, Transform());
    for (const InstanceEntity &i : scene.instances)
        for (const ObjectEntity &o : scene.objects)
            if (o.name == i.name)
                for (const ShapeEntity &s : o.shapes) add(s, i.ctm.start);
    std::sort(placements.begin(), placements.end(), [](const Placement &a, const Placement &b) {
        return std::pair(a.type, a.points[0].x) < std::pair(b.type, b.points[0].x);
    });
    return placements;
}

TEST_F(Conformance, TheFiveWaysToWriteOneSceneGiveTheSameScene) {
    Parsed base = ParseScene("scenes/parsing/still_base.pbrt");
    std::vector<Placement> expected = Placements(base.scene);
    ASSERT_EQ(expected.size(), 5u);
    for (const char *name : {"attributes_named", "include_import", "syntax", "transforms"}) {
        Parsed other = ParseScene(fmt::format("scenes/parsing/still_{}.pbrt", name));
        std::vector<Placement> placements = Placements(other.scene);
        ASSERT_EQ(placements.size(), expected.size()) << name;
        for (size_t i = 0; i < placements.size(); ++i) {
            EXPECT_EQ(placements[i].type, expected[i].type) << name;
            EXPECT_EQ(placements[i].material, expected[i].material) << name << " " << placements[i].type;
            ASSERT_EQ(placements[i].points.size(), expected[i].points.size());
            for (size_t j = 0; j < expected[i].points.size(); ++j)
                EXPECT_LT(Distance(placements[i].points[j], expected[i].points[j]), 1e-5f)
                    << name << " " << placements[i].type << " " << j;
        }
        EXPECT_EQ(other.scene.camera.cameraFromWorld, base.scene.camera.cameraFromWorld) << name;
        EXPECT_EQ(FloatOf(other.scene.camera.params, "fov", 90), 27) << name;
        EXPECT_EQ(IntOf(other.scene.film.params, "xresolution", 0), 96) << name;
        EXPECT_EQ(IntOf(other.scene.film.params, "yresolution", 0), 64) << name;
        EXPECT_EQ(IntOf(other.scene.integrator.params, "maxdepth", 5), 4) << name;
        EXPECT_EQ(IntOf(other.scene.sampler.params, "pixelsamples", 16), 512) << name;
        EXPECT_EQ(other.scene.areaLights.size(), 1u) << name;
        EXPECT_EQ(other.scene.lights.size(), 1u) << name;
    }
}

}  // namespace
}  // namespace pbrt::test
