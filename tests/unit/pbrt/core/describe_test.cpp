#include "pbrt/core/param_reader.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pbrt/core/effective_params_text.h"
#include "support/given_params.h"

namespace pbrt {
namespace {

enum class Wrap { Repeat, Black };
constexpr NamedValue<Wrap> kWraps[] = {{"repeat", Wrap::Repeat}, {"black", Wrap::Black}};
using Vec3 = std::array<Float, 3>;
using test::Params;

/// Parameters with one member of every type that src/pbrt/core can read.
struct Sample {
    int leaves = 4096;
    Float angle = 30;
    bool prepass = true;
    std::string file, mode = "a", mesh;
    Wrap wrap = Wrap::Black;
    std::optional<Float> width;
    std::optional<std::array<int, 2>> bounds;
    Vec3 from{1, 2, 3};
    std::vector<Vec3> points;
    std::span<const int> indices;
    Float only = 0;

    template <class V>
    void Describe(V &&v) {
        v("leaves", leaves, Range{1, 10000}, "how many");
        v("angle", angle, Range<Float>{0, 180, true, true, "degrees"}, "how wide");
        v("prepass", prepass, "collect first");
        v("file", file, "what is read");
        v("mode", mode, Choices{"a", "b"}, "the way");
        v("mesh", mesh, Required(), "the mesh");
        v("wrap", wrap, kWraps, "what lies outside");
        v("width", width, Positive(10), "unless it follows from others");
        v("bounds", bounds, Range{0, 9}, "from and to");
        v("from", from, Items{ParamType::Point3}, "where");
        v("points", points, Items{ParamType::Point3, {-5, 5}}, "where else");
        v("indices", indices, "which");
        if (v.When(mode == "b")) v("only", only, "of mode b");
    }
};

struct Few {
    int leaves = 7;
    Float floor = 0.25f;
    Wrap wrap = Wrap::Repeat;
    template <class V>
    void Describe(V &&v) {
        v("leaves", leaves, Range{1, 10}, "");
        v("floor", floor, "");
        v("wrap", wrap, kWraps, "");
    }
};

/// All errors, first those thrown, then those about unused parameters, as lines "line message".
std::string Wrong(const ParamSet &given, Sample *sample = nullptr) {
    Sample fresh;
    DiagnosticSink sink;
    std::string all;
    auto add = [&](const Diagnostic &d) { all += fmt::format("{} {}\n", d.loc.line, d.message); };
    ParamReader reader(given);
    (sample ? *sample : fresh).Describe(reader);
    try {
        reader.Finish(sink);
    } catch (const UserError &e) {
        for (const Diagnostic &d : e.Diagnostics()) add(d);
    }
    for (const Diagnostic &d : sink.All()) add(d);
    return all;
}

TEST(Describe, OneListingDocumentsAndPrints) {
    std::string table;
    for (const ParamDoc &d : DocumentParams<Sample>())
        table += fmt::format("{} {} {} = {} ({})\n", d.ShortType(), d.TypeText(), d.name, d.defaultValue, d.range);
    EXPECT_EQ(table,
              "i integer leaves = 4096 (1 to 10000)\n"
              "f float angle = 30 (above 0, below 180 degrees)\n"
              "b bool prepass = true ()\n"
              "s string file =  ()\n"
              "s string mode = a (a, b)\n"
              "s string mesh =  (required)\n"
              "s string wrap = black (repeat, black)\n"
              "f float width =  (above 0 to 10)\n"
              "i[] integer[] bounds =  (2 values, each 0 to 9)\n"
              "p3 point3 from = 1 2 3 ()\n"
              "p3[] point3[] points =  (-5 to 5)\n"
              "i[] integer[] indices =  ()\n"
              "f float only = 0 ()\n");
    EXPECT_EQ(EffectiveParamsText(Few()), "{\"leaves\":7,\"floor\":0.25,\"wrap\":\"repeat\"}");
}

TEST(Describe, RangesAreWrittenShort) {
    EXPECT_EQ(ShortText(Range{1, std::numeric_limits<int>::max()}), "at least 1");
    EXPECT_EQ(ShortText(Positive(std::numeric_limits<Float>::max(), "m")), "above 0 m");
    EXPECT_EQ(ShortText(AnyFloat()), "");
    EXPECT_EQ(ShortText(AnyFloat("degrees")), "degrees");
}

TEST(Describe, EveryTypeIsRead) {
    Sample s;
    Params given("Thing");
    given.Integer("leaves", 12).Number("angle", 1).Bool("prepass", false).String("file", "x").String("mode", "b");
    given.String("mesh", "m").String("wrap", "repeat").Number("width", 2).Integers("bounds", {3, 4});
    given.Point("from", {4, 5, 6}).Floats(ParamType::Point3, "points", {1, 2, 3, 4, 5, -5});
    given.Integers("indices", {7, 8, 9}).Number("only", 1);
    EXPECT_EQ(Wrong(given, &s), "");
    EXPECT_EQ(s.leaves, 12);
    EXPECT_EQ(s.angle, 1);
    EXPECT_FALSE(s.prepass);
    EXPECT_EQ(s.file + s.mode + s.mesh, "xbm");
    EXPECT_EQ(s.wrap, Wrap::Repeat);
    EXPECT_EQ(s.width, Float(2));
    EXPECT_EQ(s.bounds, (std::array{3, 4}));
    EXPECT_EQ(s.from, (Vec3{4, 5, 6}));
    EXPECT_EQ(s.points, (std::vector<Vec3>{{1, 2, 3}, {4, 5, -5}}));
    EXPECT_EQ(std::vector<int>(s.indices.begin(), s.indices.end()), (std::vector{7, 8, 9}));
    EXPECT_EQ(s.only, 1);
}

TEST(Describe, WhatIsNotGivenKeepsItsDefault) {
    Sample s;
    EXPECT_EQ(Wrong(Params().String("mesh", "m"), &s), "");
    EXPECT_EQ(s.leaves, 4096);
    EXPECT_EQ(s.from, (Vec3{1, 2, 3}));
    EXPECT_FALSE(s.width || s.bounds);
}

TEST(Describe, AllErrorsAreReportedAtOnceWithTheirPlaces) {
    Params given("Thing \"x\"");
    given.Integer("leaves", 0).Number("angle", 180).String("mode", "c").String("mesh", "").String("wrap", "blak");
    given.Number("width", 0).Integer("bounds", 1).Floats(ParamType::Point3, "from", {1, 2}).Point("points", {1, 2, 6});
    given.Bool("prepas", true).Number("leaves", 3).Number("only", 1);
    EXPECT_EQ(
        Wrong(given),
        "1 Thing \"x\": \"leaves\" is 0; it must be at least 1 and at most 10000.\n"
        "2 Thing \"x\": \"angle\" is 180; it must be above 0 and below 180 degrees.\n"
        "3 Thing \"x\": \"c\" is not a choice for \"mode\"; did you mean \"a\"? valid: a, b.\n"
        "4 Thing \"x\": \"string mesh\" is missing.\n"
        "5 Thing \"x\": \"blak\" is not a choice for \"wrap\"; did you mean \"black\"? valid: repeat, black.\n"
        "6 Thing \"x\": \"width\" is 0; it must be above 0 and at most 10.\n"
        "7 Thing \"x\": \"integer bounds\" takes 2 values, found 1.\n"
        "8 Thing \"x\": \"point3 from\" takes groups of 3 values, found 2.\n"
        "9 Thing \"x\": \"points\" is 6; it must be at least -5 and at most 5.\n"
        "10 \"bool prepas\": unused parameter of Thing \"x\"; did you mean \"prepass\"? valid: angle, bounds, file, "
        "from, indices, leaves, mesh, mode, points, prepass, width, wrap.\n"
        "11 \"float leaves\": unused parameter: Thing \"x\" takes \"integer leaves\".\n"
        "12 \"float only\": unused parameter of Thing \"x\"; valid: angle, bounds, file, from, indices, leaves, "
        "mesh, mode, points, prepass, width, wrap.\n");
    auto meshed = [] { return Params("Thing \"x\"").String("mesh", "m"); };
    EXPECT_EQ(Wrong(meshed().Number("angle", std::nanf(""))),
              "2 Thing \"x\": \"angle\" is nan; it must be above 0 and below 180 degrees.\n");
    EXPECT_EQ(
        Wrong(meshed().Floats(ParamType::Float, "angle", {1, 2}).Floats(ParamType::Point3, "from", {1, 2, 3, 4, 5, 6})),
        "2 Thing \"x\": \"float angle\" takes 1 value, found 2.\n"
        "3 Thing \"x\": \"point3 from\" takes 3 values, found 6.\n");
}

TEST(Describe, TheLastOfEqualOnesWinsAndDefaultsAreNeverReported) {
    Sample s;
    Params given = Params().String("mesh", "m").Integer("leaves", 1).Integer("leaves", 2);
    given.Default(ParamType::Float, "nothing", {}).Default(ParamType::Float, "angle", {9});
    EXPECT_EQ(Wrong(given, &s), "");
    EXPECT_EQ(s.leaves, 2);
    EXPECT_EQ(s.angle, 9);
}

}  // namespace
}  // namespace pbrt
