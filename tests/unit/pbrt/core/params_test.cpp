#include "pbrt/core/params.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pbrt {
namespace {

Param Floats(const std::string &name, std::vector<Float> values, ParamType type = ParamType::Float) {
    Param p;
    p.type = type;
    p.name = name;
    p.floats = std::move(values);
    return p;
}

Param Ints(const std::string &name, std::vector<int> values) {
    Param p;
    p.type = ParamType::Integer;
    p.name = name;
    p.ints = std::move(values);
    return p;
}

Param Strings(const std::string &name, std::vector<std::string> values) {
    Param p;
    p.type = ParamType::String;
    p.name = name;
    p.strings = std::move(values);
    return p;
}

std::string Unused(const ParamSet &set) {
    DiagnosticSink sink;
    set.ReportUnused(sink);
    std::string all;
    for (const Diagnostic &d : sink.All()) all += d.message + "\n";
    return all;
}

TEST(ParamSet, NameAndTypeMustBothMatch) {
    ParamSet set("Shape \"s\"", {});
    set.Add(Ints("x", {3}));
    EXPECT_EQ(set.GetFloat("x", 7), 7);
    EXPECT_EQ(set.GetInt("X", 7), 7);
    EXPECT_TRUE(set.Has("x"));
    EXPECT_NE(Unused(set).find("Shape \"s\" takes \"float x\""), std::string::npos) << Unused(set);
    EXPECT_EQ(set.GetInt("x", 7), 3);
    EXPECT_EQ(Unused(set), "");
}

TEST(ParamSet, TheLastOfEqualOnesWinsAndOwnOnesBeatDefaults) {
    ParamSet set;
    set.Add(Floats("a", {1}));
    set.Add(Floats("a", {2}));
    set.AddDefault(Floats("a", {3}));
    set.AddDefault(Floats("b", {4}));
    set.AddDefault(Floats("b", {5}));
    EXPECT_EQ(set.GetFloat("a", 0), 2);
    EXPECT_EQ(set.GetFloat("b", 0), 5);
    EXPECT_EQ(Unused(set), "") << "shadowed ones and defaults are not unused";
}

TEST(ParamSet, DefaultsAreNeverReported) {
    ParamSet set;
    set.AddDefault(Floats("b", {4}));
    EXPECT_EQ(Unused(set), "");
}

TEST(ParamSet, ScalarsHaveOneValue) {
    ParamSet set;
    set.Add(Floats("a", {1, 2}));
    set.Add(Floats("e", {}));
    EXPECT_THROW(set.GetFloat("a", 0), UserError);
    EXPECT_THROW(set.GetFloat("e", 0), UserError);
}

TEST(ParamSet, ListsAreWholeItems) {
    ParamSet set;
    set.Add(Floats("p", {1, 2, 3, 4}, ParamType::Point3));
    set.Add(Floats("u", {1, 2, 3, 4}, ParamType::Point2));
    EXPECT_THROW(set.GetFloats("p", ParamType::Point3), UserError);
    EXPECT_EQ(set.GetFloats("u", ParamType::Point2).size(), 4u);
    EXPECT_TRUE(set.GetFloats("none").empty());
}

TEST(ParamSet, ChoicesAreClosed) {
    ParamSet set("Film \"rgb\"", {});
    set.Add(Strings("wrap", {"repaet"}));
    EXPECT_EQ(set.GetChoice("mode", "a", {"a", "b"}), "a");
    try {
        set.GetChoice("wrap", "repeat", {"repeat", "black"});
        FAIL();
    } catch (const UserError &e) {
        EXPECT_NE(std::string(e.what()).find("did you mean \"repeat\""), std::string::npos) << e.what();
    }
}

TEST(ParamSet, UnknownNamesListWhatCouldBeGiven) {
    ParamSet set("Shape \"sphere\"", {});
    Param typo = Floats("radiuss", {1});
    typo.loc = {std::make_shared<SourceFile>(SourceFile{"f", "text"}), 1, 2};
    set.Add(typo);
    set.GetFloat("radius", 1);
    set.GetFloat("zmin", 1);
    DiagnosticSink sink;
    set.ReportUnused(sink);
    ASSERT_EQ(sink.ErrorCount(), 1u);
    EXPECT_EQ(sink.All()[0].loc.column, 2);
    EXPECT_NE(sink.All()[0].message.find("did you mean \"radius\"? valid: radius, zmin"), std::string::npos)
        << sink.All()[0].message;
    set.MarkAllUsed();
    EXPECT_EQ(Unused(set), "");
}

TEST(ParamSet, LocOfPointsAtTheParameterElseTheDirective) {
    auto file = std::make_shared<SourceFile>(SourceFile{"f", "text"});
    ParamSet set("x", {file, 1, 0});
    Param p = Floats("a", {1});
    p.loc = {file, 2, 5};
    set.Add(p);
    EXPECT_EQ(set.LocOf("a").line, 2);
    EXPECT_EQ(set.LocOf("b").line, 1);
}

TEST(ParamType, NamesAreThoseOfTheFormat) {
    EXPECT_STREQ(Name(ParamType::Integer), "integer");
    EXPECT_STREQ(Name(ParamType::Normal), "normal");
    EXPECT_STREQ(Name(ParamType::Bool), "bool");
    EXPECT_STREQ(Name(ParamType::Rgb), "rgb");
    EXPECT_STREQ(Name(ParamType::Texture), "texture");
}

TEST(ParamSet, RangesAreCheckedWhereAValueIsGiven) {
    ParamSet set("Shape \"s\"", {});
    set.Add(Floats("radius", {-1}));
    set.Add(Floats("fov", {180}));
    set.Add(Ints("levels", {11}));
    auto message = [](auto &&get) -> std::string {
        try {
            get();
        } catch (const UserError &e) {
            return e.Diagnostics().front().message;
        }
        return "";
    };
    EXPECT_EQ(message([&] { set.GetFloat("radius", 1, Positive(1e18f)); }),
              "Shape \"s\": \"radius\" is -1; it must be above 0 and at most 1e+18.");
    EXPECT_EQ(message([&] {
                  set.GetFloat("fov", 1, {0, 180, true, true});
              }),
              "Shape \"s\": \"fov\" is 180; it must be above 0 and below 180.");
    EXPECT_EQ(message([&] {
                  set.GetInt("levels", 1, {0, 10});
              }),
              "Shape \"s\": \"levels\" is 11; it must be at least 0 and at most 10.");
    EXPECT_EQ(set.GetFloat("fov", 1, {0, 180}), 180);
    EXPECT_EQ(set.GetFloat("absent", -7, {0, 1}), -7) << "the default is the caller's affair";
    EXPECT_FALSE((Range<Float>{0, 1}.Contains(std::nanf(""))));
    EXPECT_EQ(Unused(set), "");
}

}  // namespace
}  // namespace pbrt
