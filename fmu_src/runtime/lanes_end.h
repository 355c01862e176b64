/* End the scope of lanes.h: the instructions of this width, and LANES. */
#if LANES > 2 && defined(__clang__)
#pragma clang attribute pop
#elif LANES > 2
#pragma GCC pop_options
#endif
#undef real
#undef real_mask
#undef LANES_LEAVE
#undef LANES_NAME
#undef LANES
