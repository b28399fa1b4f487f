# Shell completion and the manual page, which the program prints.
set(folder ${CMAKE_BINARY_DIR}/completion)
set(completion_files "")
foreach(kind_and_file "bash gladstone" "zsh _gladstone" "fish gladstone.fish" "man gladstone.1")
  separate_arguments(kind_and_file)
  list(GET kind_and_file 0 kind)
  list(GET kind_and_file 1 file)
  add_custom_command(OUTPUT ${folder}/${file} COMMAND ${CMAKE_COMMAND} -E make_directory ${folder}
                     COMMAND gladstone completion ${kind} > ${folder}/${file} DEPENDS gladstone VERBATIM)
  list(APPEND completion_files ${folder}/${file})
endforeach()
add_custom_target(gladstone_completion ALL DEPENDS ${completion_files})

install(FILES ${folder}/gladstone DESTINATION share/bash-completion/completions COMPONENT program)
install(FILES ${folder}/gladstone.fish DESTINATION share/fish/vendor_completions.d COMPONENT program)
install(FILES ${folder}/gladstone.1 DESTINATION share/man/man1 COMPONENT program)
# zsh searches /usr/local/share/zsh/site-functions, and on Debian /usr/share/zsh/vendor-completions
install(FILES ${folder}/_gladstone DESTINATION share/zsh/site-functions COMPONENT zsh)
install(FILES ${folder}/_gladstone DESTINATION share/zsh/vendor-completions COMPONENT debian EXCLUDE_FROM_ALL)
