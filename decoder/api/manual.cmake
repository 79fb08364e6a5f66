# Writes what the program says of itself: man pages into FOLDER/man, completion scripts into
# FOLDER/completion. PROGRAM is the program; STAMP is touched last.
function(ask file)
  execute_process(COMMAND ${PROGRAM} ${ARGN} OUTPUT_VARIABLE text COMMAND_ERROR_IS_FATAL ANY)
  file(WRITE ${FOLDER}/${file} "${text}")
endfunction()

file(REMOVE_RECURSE ${FOLDER}/man ${FOLDER}/completion)
ask(man/tagsmith.1 help --man)
file(STRINGS ${FOLDER}/man/tagsmith.1 entries REGEX "^\\.BR tagsmith.*-[a-z]+ ")
foreach(entry IN LISTS entries)
  string(REGEX REPLACE ".*-([a-z]+) .*" "\\1" command "${entry}")
  ask(man/tagsmith-${command}.1 help --man ${command})
endforeach()
ask(completion/tagsmith completion bash)
ask(completion/_tagsmith completion zsh)
ask(completion/tagsmith.fish completion fish)
file(TOUCH ${STAMP})
