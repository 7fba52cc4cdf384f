# What ctest starts first where it has not measured yet: the longest, in seconds on two cores, so that none of them is
# the last one, alone. Most of them wait: for a node of Slurm, for a program that is killed again and again.
foreach(test IN ITEMS app.Slurm.ATaskThatIsToldToStopAndANodeThatDiesLoseNothing=70
                      app.Resume.OfAMovieThatWasKilledIsTheSameMovie=33
                      app.Resume.OfPicturesThatWereKilledIsTheSamePictures=25
                      app.Slurm.FourShardsAndAJoinAreOneRun=10
                      faults.Faults.AMovieIsRightOrIsNotThere=10
                      faults.Faults.AMatroskaIsRightOrIsNotThere=9
                      app.Resume.AJoinThatWasKilledIsDoneAgain=8
                      app.Slurm.AFailedTaskIsNamedWithItsLogAndRepairedBySubmittingAgain=8
                      faults.Faults.EachPictureIsRightOrIsNotThere=7
                      faults.Faults.AGifIsRightOrIsNotThere=7
                      app.Shards.JoinedAreTheFilmInOneGo=7)
  string(REPLACE = ";" named ${test})
  list(GET named 0 name)
  list(GET named 1 seconds)
  set_tests_properties(${name} PROPERTIES COST ${seconds})
endforeach()
