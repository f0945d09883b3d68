! The Fortran module: u1 - u2 = u4, twice; u2 - u3 = 0.5; u4 is prescribed.
program tied
    use, intrinsic :: iso_c_binding
    use qless
    implicit none
    type(qless_analysis) :: analysis
    type(qless_elimination) :: elimination
    integer(c_int64_t) :: equations, dofs, rank, redundant, conflicting
    integer(c_int32_t), allocatable :: rows(:), slaves(:), masters(:), prescribed(:), starts(:), columns(:)
    integer(c_int8_t) :: kinds(3)
    real(c_double), allocatable :: coefficients(:), values(:)
    real(c_double) :: u(4), q(1), lambda(3), g(2)
    character(len=:), allocatable :: message
    integer :: ierr

    call qless_analyse(4_c_int64_t, [1, 4, 7, 9], [1, 2, 4, 1, 2, 4, 2, 3], &
                       [1d0, -1d0, -1d0, 2d0, -2d0, -2d0, 1d0, -1d0], [0d0, 0d0, 0.5d0], [4], [0.25d0], analysis, ierr)
    call need(ierr == 0)
    call qless_counts(analysis, equations, dofs, rank, redundant, conflicting, ierr)
    call need(ierr == 0 .and. rank == 2 .and. redundant == 1 .and. conflicting == 0)
    call qless_kinds(analysis, kinds, ierr)
    call need(ierr == 0 .and. all(kinds == [0, 1, 0]))
    call qless_explain(analysis, 2_c_int64_t, rows, coefficients, ierr)
    call need(ierr == 0 .and. all(rows == [1]) .and. all(coefficients == [2d0]))
    call qless_explain(analysis, 4_c_int64_t, rows, coefficients, ierr)
    message = qless_message()
    call need(ierr < 0 .and. index(message, "out of range") > 0)

    call qless_eliminate(analysis, elimination, ierr)
    call need(ierr == 0)
    call qless_free_analysis(analysis, ierr)
    call qless_dofs(elimination, slaves, masters, prescribed, ierr)
    call need(ierr == 0 .and. size(slaves) == 2 .and. size(masters) == 1 .and. all(prescribed == [4]))
    call qless_t(elimination, starts, columns, values, ierr)
    call need(ierr == 0 .and. all(starts == [1, 2, 3]) .and. all(columns == 1) .and. all(values == 1d0))
    call qless_expand(elimination, [7d0], u, ierr)
    call need(ierr == 0 .and. u(1) - u(2) == 0.25d0 .and. u(2) - u(3) == 0.5d0)
    call qless_restrict(elimination, [1d0, 1d0, 1d0, 1d0], q, ierr)
    call need(ierr == 0 .and. q(1) == 3d0)
    call qless_multipliers(elimination, [1d0, 1d0, 1d0, 1d0], lambda, ierr)
    call need(ierr == 0 .and. lambda(2) == 0d0)
    call qless_refresh(elimination, [1d0, 3d0, 0d0], [0d0], ierr)
    call need(ierr == -2)
    call qless_refresh(elimination, [1d0, 2d0, 0d0], [0d0], ierr)
    call qless_g(elimination, g, ierr)
    call need(ierr == 0 .and. maxval(abs(g)) == 1d0)
    call qless_free_elimination(elimination, ierr)
    call qless_expand(elimination, [7d0], u, ierr)
    call need(ierr == -1)
    call condense()
    call explain()
    call clean_a_deck()
    print '(a)', "module: as expected"

contains

    ! A chain of three springs whose ends are tied: by K, and by its elements.
    subroutine condense()
        type(qless_pattern) :: pattern
        real(c_double) :: k(10) = [1d0, -1d0, -1d0, 2d0, -1d0, -1d0, 2d0, -1d0, -1d0, 1d0], f(4) = 0d0, kq(4), fq(2), added(4)
        call qless_analyse(4_c_int64_t, [1, 3], [4, 1], [1d0, -1d0], [0d0], [2], [1d0], analysis, ierr)
        call qless_eliminate(analysis, elimination, ierr)
        call qless_free_analysis(analysis, ierr)
        call qless_condensed(elimination, qless_by_rows, qless_full, qless_eliminated, [1, 3, 6, 9, 11], &
                             [1, 2, 1, 2, 3, 2, 3, 4, 3, 4], pattern, ierr)
        call need(ierr == 0)
        call qless_pattern_arrays(pattern, starts, columns, masters, ierr)
        call need(ierr == 0 .and. all(starts == [1, 3, 5]) .and. all(columns == [1, 2, 1, 2]) .and. size(masters) == 2)
        call qless_condense(pattern, k, f, kq, fq, ierr)
        call need(ierr == 0 .and. all(fq == 1d0) .and. kq(2) == -1d0)
        call qless_free_pattern(pattern, ierr)
        call qless_condensed_for_elements(elimination, qless_full, qless_eliminated, [1, 3, 5, 7], [1, 2, 2, 3, 3, 4], pattern, &
                                          ierr)
        call need(ierr == 0)
        call qless_assemble(pattern, spring, c_null_ptr, added, fq, ierr)
        call need(ierr == 0 .and. all(added == kq) .and. all(fq == 1d0))
        added = 0d0
        fq = 0d0
        call qless_add_element(pattern, [1, 2], reshape([1d0, -1d0, -1d0, 1d0], [2, 2]), [0d0, 0d0], added, fq, ierr)
        call qless_add_element(pattern, [2, 3], reshape([1d0, -1d0, -1d0, 1d0], [2, 2]), [0d0, 0d0], added, fq, ierr)
        call qless_add_element(pattern, [3, 4], reshape([1d0, -1d0, -1d0, 1d0], [2, 2]), [0d0, 0d0], added, fq, ierr)
        call need(ierr == 0 .and. all(added == kq) .and. all(fq == 1d0))
        call qless_free_pattern(pattern, ierr)
        call qless_free_elimination(elimination, ierr)
    end subroutine

    integer(c_int) function spring(context, element, matrix, forces) bind(c)
        type(c_ptr), value :: context
        integer(c_int64_t), value :: element
        real(c_double), intent(inout) :: matrix(*), forces(*)
        spring = merge(0_c_int, 1_c_int, element >= 1 .and. .not. c_associated(context))
        matrix(1:4) = [1d0, -1d0, -1d0, 1d0]
        forces(1:2) = 0d0
    end function

    ! u1 = u2 = u3, and the ends are prescribed.
    subroutine explain()
        type(qless_member), allocatable :: members(:)
        type(qless_change), allocatable :: changes(:, :)
        integer(c_int64_t), allocatable :: conflicts(:)
        integer(c_int64_t) :: groups
        real(c_double) :: rhs, reactions(1)
        integer :: doubt, irreducible
        call qless_analyse(3_c_int64_t, [1, 3, 5], [1, 2, 2, 3], [1d0, -1d0, 1d0, -1d0], [0d0, 0d0], [1, 3], [0.5d0, 0d0], &
                           analysis, ierr)
        call qless_fixed(analysis, rows, coefficients, ierr)
        call need(ierr == 0 .and. all(rows == [2]) .and. size(coefficients) == 1)
        call qless_reason(analysis, qless_equation, 2_c_int64_t, members, rhs, irreducible, ierr)
        call need(ierr == 0 .and. size(members) == 3 .and. rhs == 0.5d0 .and. members(3)%index == 3 .and. irreducible == 1)
        call qless_repairs(analysis, groups, ierr)
        call need(ierr == 0 .and. groups == 1)
        call qless_repair(analysis, 1_c_int64_t, conflicts, changes, ierr)
        call need(ierr == 0 .and. all(conflicts == [2]) .and. all(shape(changes) == [1, 4]))
        call need(changes(1, 1)%what == qless_prescribed)
        call qless_doubt(analysis, doubt, message, ierr)
        call need(ierr == 0 .and. doubt == 0 .and. message == "")
        call qless_label(analysis, qless_dof, 3_c_int64_t, message, ierr)
        call need(ierr == 0 .and. message == "DOF 3")
        call qless_free_analysis(analysis, ierr)
        call qless_analyse(3_c_int64_t, [1, 3, 5], [1, 2, 2, 3], [1d0, -1d0, 1d0, -1d0], [0d0, 0d0], [1], [0.5d0], analysis, ierr)
        call qless_eliminate(analysis, elimination, ierr)
        call qless_multipliers(elimination, [1d0, 1d0, 1d0], lambda(1:2), ierr)
        call qless_reactions(elimination, [1d0, 1d0, 1d0], lambda(1:2), reactions, ierr)
        call need(ierr == 0 .and. reactions(1) == -3d0)
        call qless_free_analysis(analysis, ierr)
        call qless_free_elimination(elimination, ierr)
    end subroutine

    subroutine clean_a_deck()
        type(qless_deck) :: deck
        integer(c_int64_t) :: left_out, removed, written
        call qless_read_deck(DECK, deck, ierr)
        call need(ierr == 0)
        call qless_deck_warnings(deck, message, left_out, ierr)
        call need(ierr == 0 .and. message == "" .and. left_out == 0)
        call qless_analyse_deck(deck, -1_c_int64_t, analysis, ierr)
        call need(ierr == 0)
        call qless_label(analysis, qless_equation, 3_c_int64_t, message, ierr)
        call need(message == "line 13 *EQUATION 1:1")
        call qless_free_analysis(analysis, ierr)
        call qless_clean_deck(deck, "no/such/folder.inp", removed, written, ierr)
        call need(ierr == -5)
        call qless_free_deck(deck, ierr)
    end subroutine

    subroutine need(condition)
        logical, intent(in) :: condition
        if (.not. condition) then
            print '(a)', qless_message()
            error stop 1
        end if
    end subroutine
end program
