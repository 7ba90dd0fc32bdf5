#include <gtest/gtest.h>

#include "light_test_support.h"
#include "pbrt/lights/light_factory.h"
#include "pbrt/lights/light_image.h"
#include "support/errors.h"

namespace pbrt::test {
namespace {

void ExpectComplaint(const std::string &type, const ParamSet &params, int line, const std::string &part) {
    ExpectErrorAt([&] { Make(type, params); }, line, {part});
}

TEST(LightFactory, UnknownLightListsTheKnownOnes) {
    ExpectComplaint("spott", Params(), 100, "did you mean \"spot\"");
    ExpectComplaint("spott", Params(), 100, "infinite");
}

TEST(LightFactory, PortalsAreChecked) {
    auto corners = [](std::vector<Float> v) {
        return Params().Rgb("L", 1, 1, 1).Floats(ParamType::Point3, "portal", std::move(v));
    };
    ExpectComplaint("infinite", corners(std::vector<Float>(9, 0)), 2, "4 corners");
    ExpectComplaint("infinite", corners(std::vector<Float>(12, 0)), 2, "do not span");
    ExpectComplaint("infinite", corners({0, 0, 0, 1, 0, 0, 1, 0, 0, 2, 0, 0}), 2, "do not span");
    ExpectComplaint("infinite", Params().Floats(ParamType::Point3, "portal", {0, 0, 0, 0, 1, 0, 1, 1, 0, 1, 0, 0}), 1,
                    "needs");
    DiagnosticSink sink;
    for (bool good : {true, false}) {
        auto light =
            Make("infinite", corners({0, 0, 0, 0, 1, 0, 1, 1, good ? Float(0) : Float(0.5), 1, 0, 0}), {}, {}, sink);
        EXPECT_TRUE(light);
        EXPECT_EQ(sink.All().size(), good ? 0u : 1u);
        EXPECT_FALSE(sink.HasErrors());
    }
    ExpectWords(sink.All()[0].message, {"not a rectangle"});
}

TEST(LightFactory, ImagesOfLightsAreChecked) {
    ExpectComplaint("projection", Params().Number("fov", 40), 100, "filename");
    ExpectComplaint("projection", Params().String("filename", "/nowhere/slide.png"), 1, "slide.png");
    ExpectComplaint("projection", Params().String("filename", "/nowhere/slide.png").Number("fov", 180), 2, "fov");
    TemporaryImage wide("wide2.exr", RgbImage({4, 2}, [](int, int) { return Rgb(1); }));
    ExpectComplaint("goniometric", Params().String("filename", wide.Path()), 1, "square");
    TemporaryImage black("black.exr", RgbImage({2, 2}, [](int, int) { return Rgb(0); }));
    for (const char *type : {"goniometric", "projection"}) {
        ExpectComplaint(type, Params().String("filename", black.Path()).Number("power", 5), 2, "black");
        EXPECT_TRUE(Make(type, Params().String("filename", black.Path()))) << "black light is legal";
    }
    Image depth(PixelFormat::Float, {2, 2}, {"Z"});
    TemporaryImage neither("neither.exr", depth);
    ExpectComplaint("goniometric", Params().String("filename", neither.Path()), 1, "channel Y");
    ExpectComplaint("projection", Params().String("filename", neither.Path()), 1, "R, G and B");
}

TEST(LightFactory, WhatIsTooBrightForSinglePrecisionIsAnError) {
    for (const char *type : {"point", "spot", "distant", "goniometric", "infinite"}) {
        const std::string name = std::string(type) == "distant" || std::string(type) == "infinite" ? "L" : "I";
        ExpectComplaint(type, Params().Rgb(name, 1e25f, 1, 1).Number("scale", 1e30f), 2, "largest number");
        EXPECT_TRUE(Make(type, Params().Rgb(name, 1, 1, 1).Number("scale", 1e30f))) << type;
    }
    for (const char *type : {"point", "spot", "goniometric"})
        ExpectComplaint(type, Params().Number("scale", 1e30f).Number("power", 1e30f), 1, "largest number");
    for (const char *type : {"distant", "infinite"})
        ExpectComplaint(type, Params().Number("scale", 1e30f).Number("illuminance", 1e30f), 1, "largest number");
    const Diagnostic d = OnlyErrorOf([] { MakeAreaMaker(Params().Rgb("L", 1e25f, 1, 1).Number("scale", 1e30f)); });
    ExpectWords(d.message, {"largest number"});
}

TEST(LightFactory, RadianceAndImageExcludeEachOther) {
    ExpectComplaint("infinite", Params().Rgb("L", 1, 1, 1).String("filename", "x.exr"), 2, "exclude");
    Diagnostic d = OnlyErrorOf([] { MakeAreaMaker(Params().Rgb("L", 1, 1, 1).String("filename", "x.exr")); });
    EXPECT_EQ(d.loc.line, 2);
}

TEST(LightFactory, MissingImageIsLocated) {
    ExpectComplaint("infinite", Params().String("filename", "/nowhere/sky.exr"), 1, "sky.exr");
}

TEST(LightFactory, EnvironmentMustBeSquareFiniteRgb) {
    TemporaryImage wide("wide.exr", RgbImage({4, 2}, [](int, int) { return Rgb(1); }));
    ExpectComplaint("infinite", Params().String("filename", wide.Path()), 1, "square");
    TemporaryImage holes("holes.exr", RgbImage({2, 2}, [](int x, int) { return x ? Rgb(Infinity) : Rgb(1); }));
    ExpectComplaint("infinite", Params().String("filename", holes.Path()), 1, "infinite");
    Image grey(PixelFormat::Float, {2, 2}, {"Y"});
    TemporaryImage mono("mono.exr", grey);
    ExpectComplaint("infinite", Params().String("filename", mono.Path()), 1, "R, G and B");
}

TEST(LightFactory, NothingEmitsLessThanNothing) {
    for (const char *type : {"point", "infinite"}) {
        ExpectComplaint(type, Params().Number("scale", -1), 1, "at least 0");
        ExpectComplaint(
            type, Params().Floats(ParamType::Spectrum, type == std::string("point") ? "I" : "L", {400, -1, 700, 1}), 1,
            "400 nm is -1");
    }
}

TEST(LightFactory, DirectionNeedsTwoPoints) {
    ExpectComplaint("distant", Params().Point("from", {0, 0, 1}), 1, "same point");
    ExpectComplaint("spot", Params().Point("from", {1, 2, 3}).Point("to", {1, 2, 3}), 2, "same point");
}

TEST(LightFactory, ConeAnglesAreChecked) {
    ExpectComplaint("spot", Params().Number("coneangle", 0), 1, "coneangle");
    ExpectComplaint("spot", Params().Number("coneangle", 30).Number("conedeltaangle", -1), 2, "conedeltaangle");
    ExpectComplaint("spot", Params().Number("coneangle", 30).Number("conedeltaangle", 61), 2, "conedeltaangle");
}

TEST(LightFactory, UnknownAreaLight) {
    DiagnosticSink sink;
    Diagnostic d = OnlyErrorOf([&] { MakeAreaMaker(Params(), sink, "difuse"); });
    ExpectWords(d.message, {"did you mean \"diffuse\""});
}

TEST(LightFactory, EveryParameterOfALightIsAskedFor) {
    TemporaryImage image("asked.exr", RgbImage({4, 4}, [](int, int) { return Rgb(1); }));
    struct Row {
        const char *type;
        Params params;
    };
    Row rows[] = {
        {"point", Params().Rgb("I", 1, 1, 1).Number("scale", 1).Number("power", 1).Point("from", {0, 0, 0})},
        {"spot", Params()
                     .Rgb("I", 1, 1, 1)
                     .Number("scale", 1)
                     .Number("power", 1)
                     .Point("from", {0, 0, 0})
                     .Point("to", {1, 0, 0})
                     .Number("coneangle", 20)
                     .Number("conedeltaangle", 3)},
        {"distant", Params()
                        .Rgb("L", 1, 1, 1)
                        .Number("scale", 1)
                        .Number("illuminance", 1)
                        .Point("from", {0, 0, 0})
                        .Point("to", {1, 0, 0})},
        {"infinite", Params().Rgb("L", 1, 1, 1).Number("scale", 1).Number("illuminance", 1)},
        {"infinite", Params()
                         .String("filename", image.Path())
                         .Number("scale", 1)
                         .Number("illuminance", 1)
                         .Floats(ParamType::Point3, "portal", {0, 0, 0, 0, 1, 0, 1, 1, 0, 1, 0, 0})},
        {"goniometric",
         Params().Rgb("I", 1, 1, 1).Number("scale", 1).Number("power", 1).String("filename", image.Path())},
        {"projection",
         Params().Number("fov", 50).Number("scale", 1).Number("power", 1).String("filename", image.Path())},
    };
    for (Row &row : rows) {
        DiagnosticSink sink;
        EXPECT_TRUE(Make(row.type, row.params, {}, {}, sink));
        EXPECT_FALSE(sink.HasErrors()) << row.type << ": " << (sink.All().empty() ? "" : sink.All()[0].message);
    }
    Params area = Params().Rgb("L", 1, 1, 1).Number("scale", 1).Bool("twosided", true).Number("power", 1);
    DiagnosticSink sink;
    MakeAreaMaker(area, sink);
    EXPECT_FALSE(sink.HasErrors());
}

TEST(InternSpectrum, EqualEmissionIsOneObject) {
    RgbIlluminantSpectrum a(ColorSpace::SRGB(), {1, 0.5f, 0.2f}), same(ColorSpace::SRGB(), {1, 0.5f, 0.2f}),
        other(ColorSpace::SRGB(), {1, 0.5f, 0.3f});
    auto first = InternSpectrum(a);
    EXPECT_EQ(first, InternSpectrum(same));
    EXPECT_NE(first, InternSpectrum(other));
    EXPECT_NEAR((*first)(550), a(550), 1e-6);
}

}  // namespace
}  // namespace pbrt::test
