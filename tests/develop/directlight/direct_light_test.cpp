#include <gtest/gtest.h>

#include "pbrt/build/integrator_builder.h"
#include "support/build_text.h"

namespace pbrt {

void AddDirectLight(IntegratorTable &table);

/// A floor and a ball under one point light, rendered by `simplepath` with a single scattering event.
TEST(DirectLight, IsTheSingleScatteringOfSimplePath) {
    BuiltScene built = test::BuildText(R"(
        LookAt 0 -4 2  0 0 0  0 0 1 Camera "perspective"
        Film "rgb" "integer xresolution" 16 "integer yresolution" 16 "bool savefp16" false
        Sampler "independent" "integer pixelsamples" 4
        Integrator "simplepath" "integer maxdepth" 1
        WorldBegin
        LightSource "point" "point3 from" [1 -1 3] "rgb I" [20 20 20]
        Shape "sphere"
        Shape "bilinearmesh" "point3 P" [-9 -9 -1  9 -9 -1  -9 9 -1  9 9 -1]
    )");
    IntegratorTable table("Integrator");
    AddDirectLight(table);
    const BuildOptions options;
    DiagnosticSink sink;
    const ParamSet params;
    const ParamReader before(params);
    const IntegratorSettings settings =
        table.Make("directlight", params, IntegratorReading{options, test::AllSamplers(), sink, before});
    ASSERT_EQ(sink.ErrorCount(), 0u);
    EXPECT_TRUE(table.Find("directlight").traits.hasLightSampler);
    EXPECT_FALSE(table.Find("directlight").traits.rendersMedia);

    Progress progress;
    const PathContext context{*built.scene, *built.camera, built.samplesPerPixel};
    const std::unique_ptr<Integrator> integrator = settings.make(context, built.film->OutputSpace());
    PrepareContext prepare = built.Preparation(progress);
    integrator->Prepare(prepare);
    const std::unique_ptr<Film> film = built.film->MakeRgbFilm();
    RenderWaves({*integrator, *built.camera, *built.filter, *film, *built.sampler, progress}, built.Settings());
    RenderWaves(built.Rendering(progress), built.Settings());

    const Image image = film->ToImage(), expected = built.film->ToImage();
    double sum = 0;
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x)
            for (int c = 0; c < 3; ++c) {
                EXPECT_FLOAT_EQ(image.Get({x, y}, c), expected.Get({x, y}, c)) << x << ' ' << y;
                sum += double(image.Get({x, y}, c));
            }
    EXPECT_GT(sum, 1);
}

}  // namespace pbrt
