# The renderer's shaders, for the target tyndall_engine. What is bound differs between variants, and every declared binding
# must be written: so they are shaders of their own and not specialization constants.
foreach(mask 0 1)
    tyndall_shader(tyndall_engine engine/depth.vert NAME depth_view_m${mask} DEFINES SHADOW=0 MASK=${mask})
    tyndall_shader(tyndall_engine engine/depth.vert NAME depth_shadow_m${mask} DEFINES SHADOW=1 MASK=${mask})
    tyndall_shader(tyndall_engine engine/depth.vert NAME depth_local_m${mask} DEFINES SHADOW=2 MASK=${mask})
endforeach()
tyndall_shader(tyndall_engine engine/depth_mask.frag NAME depth_mask_fragment)
tyndall_shader(tyndall_engine engine/forward.vert NAME forward_vertex)
foreach(sun_shadow 0 1)
    foreach(kind 00 10 20 11 21) # of local lights: LIGHTS and LOCAL_SHADOW
        string(SUBSTRING ${kind} 0 1 lights)
        string(SUBSTRING ${kind} 1 1 local_shadow)
        set(lit SUN_SHADOW=${sun_shadow} LIGHTS=${lights} LOCAL_SHADOW=${local_shadow})
        tyndall_shader(tyndall_engine engine/forward.frag NAME forward_s${sun_shadow}_l${kind}
                       DEFINES ${lit} TRANSPARENT=0 SCATTERING=0)
        tyndall_shader(tyndall_engine engine/forward.frag NAME transparent_s${sun_shadow}_l${kind}
                       DEFINES ${lit} TRANSPARENT=1 SCATTERING=0)
        tyndall_shader(tyndall_engine engine/forward.frag NAME transparent_fog_s${sun_shadow}_l${kind}
                       DEFINES ${lit} TRANSPARENT=1 SCATTERING=1)
    endforeach()
endforeach()
foreach(scattering 0 1)
    tyndall_shader(tyndall_engine engine/forward.frag NAME filter_f${scattering}
                   DEFINES SUN_SHADOW=0 LIGHTS=0 LOCAL_SHADOW=0 TRANSPARENT=2 SCATTERING=${scattering})
endforeach()
tyndall_shader(tyndall_engine engine/full_screen_far.vert NAME full_screen_far_vertex)
tyndall_shader(tyndall_engine engine/sky.frag NAME sky_fragment)
tyndall_shader(tyndall_engine engine/luminance.comp NAME luminance_compute)
tyndall_shader(tyndall_engine engine/exposure.comp NAME exposure_compute)
foreach(automatic 0 1)
    tyndall_shader(tyndall_engine engine/tone_mapping.frag NAME tone_mapping_a${automatic} DEFINES AUTOMATIC=${automatic})
endforeach()
