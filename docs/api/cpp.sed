# Headers of C++ in the form that Doxygen reads: comments of the file and behind members, and structs without C's typedef.
1,/^#/s|^// |/// |
1,/^#/s|^#|/// @file\n#|
s|^\( *[^ /#}].*\)// |\1///< |
s|^typedef struct \([A-Za-z]* {\)|struct \1|
s|^} [A-Z][A-Za-z]*;|};|
s|^CLARAY_LAYOUT(.*||
