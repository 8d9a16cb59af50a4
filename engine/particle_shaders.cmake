# The shaders of particles, for the target tyndall_engine.
tyndall_shader(tyndall_engine engine/particle_simulation.comp NAME particle_simulation)
tyndall_shader(tyndall_engine engine/particle_sort.comp NAME particle_sort_block DEFINES STEP=0)
tyndall_shader(tyndall_engine engine/particle_sort.comp NAME particle_sort_exchange DEFINES STEP=1)
tyndall_shader(tyndall_engine engine/particle_sort.comp NAME particle_merge_block DEFINES STEP=2)
tyndall_shader(tyndall_engine engine/particle_split.comp NAME particle_split)
foreach(two_sources 0 1)
    tyndall_shader(tyndall_engine engine/particle.frag NAME particle_fragment_t${two_sources}
                   DEFINES TWO_SOURCES=${two_sources})
endforeach()
foreach(local_shadow 0 1)
    tyndall_shader(tyndall_engine engine/particle.vert NAME particle_scattering_p${local_shadow}
                   DEFINES SCATTERING=1 LOCAL_SHADOW=${local_shadow})
endforeach()
# What is bound differs between these, so they are variants and not specialization constants: every declared binding must
# be written.
foreach(sun_shadow 0 1)
    foreach(kind 00 10 11) # of local lights: LIGHTS and LOCAL_SHADOW
        string(SUBSTRING ${kind} 0 1 lights)
        string(SUBSTRING ${kind} 1 1 local_shadow)
        tyndall_shader(tyndall_engine engine/particle.vert NAME particle_direct_s${sun_shadow}_l${kind}
                       DEFINES SCATTERING=0 SUN_SHADOW=${sun_shadow} LIGHTS=${lights} LOCAL_SHADOW=${local_shadow})
    endforeach()
endforeach()
