#include "features/volumetrics/fog_json_section.hpp"

namespace tyndall::volumetrics {

namespace {

void read_lobes(Section& phase, PhaseLobes& lobes, std::optional<Error>& error) {
    if (phase.has("g") && phase.has("lobes")) {
        phase.complain(phase.path_of("lobes"), "takes the place of phase.g, so that only one may be given");
    }
    lobes.count = elements(phase, "lobes", PhaseLobes::most, error, [&](Section& s, std::uint32_t i) {
        PhaseLobe& lobe = lobes.lobes[i];
        s.read("function", lobe.function,
               {{"isotropic", PhaseFunction::isotropic},
                {"rayleigh", PhaseFunction::rayleigh},
                {"henyey_greenstein", PhaseFunction::henyey_greenstein},
                {"schlick", PhaseFunction::schlick},
                {"cornette_shanks", PhaseFunction::cornette_shanks}});
        s.read("g", lobe.g);
        s.read("weight", lobe.weight);
    });
}

/// The picture at the key "image", which must be there.
void read_picture(Section& s, DensityPicture picture, Fog& fog) {
    picture.key = s.path_of("image");
    if (!s.has("image")) {
        s.complain(picture.key, "must name a PNG file beside the fog file");
    }
    s.read("image", picture.path);
    fog.pictures.push_back(std::move(picture));
}

void read_map(Section& s, Fog& fog) {
    DensityMap& map = fog.medium.map;
    read_picture(s, {}, fog);
    s.read("center_m", map.center_m);
    s.read("size_m", map.size_m);
    s.read("edge", map.edge, {{"clamp", MapEdge::clamp}, {"repeat", MapEdge::repeat}});
    s.read("bottom_m", map.bottom_m);
    s.read("top_m", map.top_m);
    s.read("fade_m", map.fade_m);
}

void read_density(Section& s, std::size_t volume, Fog& fog) {
    DensityPicture picture{.volume = volume};
    s.read_whole("slices", picture.slices, 1, DensityTexels::most);
    if (picture.slices < 1 || picture.slices > DensityTexels::most) {
        s.complain(s.path_of("slices"), "must be between 1 and " + std::to_string(DensityTexels::most) + ", not " +
                                            std::to_string(picture.slices));
        picture.slices = 1;
    }
    read_picture(s, std::move(picture), fog);
}

void read_volume(Section& s, LocalVolume& volume) {
    enum class Shape : std::uint8_t { box, ellipsoid, sphere };
    Shape shape = Shape::box;
    s.read("shape", shape, {{"box", Shape::box}, {"ellipsoid", Shape::ellipsoid}, {"sphere", Shape::sphere}});
    volume.shape = shape == Shape::box ? VolumeShape::box : VolumeShape::ellipsoid;
    s.read("center_m", volume.center_m);
    if (shape == Shape::sphere) {
        float radius_m = 1.0F;
        s.read("radius_m", radius_m);
        volume.half_size_m = glm::vec3(radius_m);
    } else {
        s.read("half_size_m", volume.half_size_m);
    }
    s.read("rotation", volume.rotation);
    s.read("edge", volume.edge);
    s.read("blend", volume.blend,
           {{"add", VolumeBlend::add},
            {"subtract", VolumeBlend::subtract},
            {"multiply", VolumeBlend::multiply},
            {"max", VolumeBlend::max}});
    if (volume.blend == VolumeBlend::multiply) {
        s.read("factor", volume.factor);
        return;
    }
    s.read_extinction("extinction_per_m", volume.extinction_per_m, volume.extinction_color);
    if (volume.blend != VolumeBlend::subtract) {
        s.read("albedo", volume.albedo);
        s.read("emission_per_m", volume.emission_per_m);
    }
}

void read_noise(Section& s, DensityNoise& noise) {
    s.read("kind", noise.kind, {{"perlin", NoiseKind::perlin}, {"perlin_worley", NoiseKind::perlin_worley}});
    s.read("amplitude", noise.amplitude);
    s.read("scale_m", noise.scale_m);
    s.read("wind_m_s", noise.wind_m_s);
    if (noise.kind == NoiseKind::perlin) {
        s.read_whole("octaves", noise.octaves, 1, DensityNoise::most_octaves);
        s.read("gain", noise.gain);
        return;
    }
    s.read("coverage", noise.coverage);
    s.read("detail", noise.detail);
    noise.detail_scale_m = 0.25F * noise.scale_m;
    s.read("detail_scale_m", noise.detail_scale_m);
    noise.detail_wind_m_s = noise.wind_m_s;
    s.read("detail_wind_m_s", noise.detail_wind_m_s);
}

} // namespace

void read_medium(Section& root, Fog& fog, std::optional<Error>& error) {
    Medium& medium = fog.medium;
    subsection(root, "medium", error, [&](Section& section) {
        subsection(section, "homogeneous", error, [&](Section& s) {
            s.read_extinction("extinction_per_m", medium.homogeneous.extinction_per_m,
                              medium.homogeneous.extinction_color);
            s.read("albedo", medium.homogeneous.albedo);
            s.read("emission_per_m", medium.homogeneous.emission_per_m);
        });
        subsection(section, "height", error, [&](Section& s) {
            s.read_extinction("extinction_per_m", medium.height.extinction_per_m, medium.height.extinction_color);
            s.read("albedo", medium.height.albedo);
            s.read("emission_per_m", medium.height.emission_per_m);
            s.read("base_height_m", medium.height.base_height_m);
            s.read("falloff_per_m", medium.height.falloff_per_m);
        });
        subsection(section, "noise", error, [&](Section& s) { read_noise(s, medium.noise); });
        subsection(section, "map", error, [&](Section& s) { read_map(s, fog); });
        elements(section, "volumes", LocalVolume::most, error, [&](Section& s, std::uint32_t i) {
            read_volume(s, medium.volumes.emplace_back());
            subsection(s, "density", error, [&](Section& density) { read_density(density, i, fog); });
        });
    });
    subsection(root, "phase", error, [&](Section& s) {
        s.read("g", medium.phase_g);
        read_lobes(s, medium.phase_lobes, error);
    });
    subsection(root, "ambient", error, [&](Section& s) {
        s.read("radiance", medium.ambient_radiance);
        s.read("sh_1", medium.ambient_sh_1);
    });
}

} // namespace tyndall::volumetrics
