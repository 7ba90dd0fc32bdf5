#include "guide_rooms.h"

#include "support/scene_text.h"

namespace pbrt::test {

const std::string kSpotAtCeiling =
    "LightSource 'spot' 'point3 from' [ 0 .6 0 ] 'point3 to' [ 1 2 1 ] 'rgb I' [ 60 60 60 ] "
    "'float coneangle' 32 'float conedeltaangle' 3";
const std::string kPanelBehindCurtain =
    Objects()
        .Attribute("", Objects().AreaLight("8 8 8", "'bool twosided' true").Quad("1 .1 1  2 .1 1  1 1 1  2 1 1"))
        .Material("diffusetransmission")
        .Quad(".8 0 -1  .8 0 3  .8 1.6 -1  .8 1.6 3");

std::string GuideRoomText(const GuideRoom &room) {
    SceneText text;
    text.InWorldSpace().LookAt("0 1.2 -2.8  0 0.8 0  0 1 0");
    if (room.fog)
        text.Head(
            "MakeNamedMedium 'fog' 'string type' 'homogeneous' 'rgb sigma_s' [ .3 .25 .2 ] "
            "'rgb sigma_a' [ .02 .02 .04 ] 'float g' .4 MediumInterface '' 'fog'");
    text.Camera(60).Film(room.size, room.size, "'bool savefp16' false");
    text.Head(fmt::format("Sampler '{}' 'integer pixelsamples' {}", room.sampler, kGuideSamples));
    text.Integrator(room.fog ? "volpath" : "path", 4, room.parameters);
    Objects world;
    world.Add(room.light).Add(room.walls).Quad(test::room::kCeiling).Quad(test::room::kFront);
    if (room.window)
        world.Quad("-3 0 3  3 0 3  -3 .8 3  3 .8 3")
            .Quad("-3 1.7 3  3 1.7 3  -3 2 3  3 2 3")
            .Quad("-3 .8 3  .5 .8 3  -3 1.7 3  .5 1.7 3")
            .Quad("1.5 .8 3  3 .8 3  1.5 1.7 3  3 1.7 3");
    else world.Quad(test::room::kBack);
    return text.World(world.Quad(test::room::kRight).Quad(test::room::kLeft).Add(room.floor).Quad(test::room::kFloor));
}

}  // namespace pbrt::test
