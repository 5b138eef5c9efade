# Comments behind members of shared structs in the form that Doxygen reads.
s|^\( *[^ /#].*\)// |\1///< |
